#include "isochor/step/step_unit.h"

#include <STEPConstruct_UnitContext.hxx>
#include <StepBasic_ConversionBasedUnitAndLengthUnit.hxx>
#include <StepBasic_HArray1OfNamedUnit.hxx>
#include <StepBasic_LengthMeasureWithUnit.hxx>
#include <StepBasic_MeasureWithUnit.hxx>
#include <StepBasic_SiUnitAndLengthUnit.hxx>
#include <StepBasic_Unit.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <unordered_map>

namespace isochor::internal {
namespace {

using Context = Handle(StepRepr_GlobalUnitAssignedContext);

Context context_of(const Handle(Standard_Transient) & entity) {
  const auto plain = Context::DownCast(entity);
  if (!plain.IsNull()) return plain;
  const auto full =
      Handle(StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx)::DownCast(entity);
  if (!full.IsNull()) return full->GlobalUnitAssignedContext();
  const auto half =
      Handle(StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext)::DownCast(entity);
  return half.IsNull() ? Context() : half->GlobalUnitAssignedContext();
}

// Asked once for each type: models have many entities of few types.
bool may_have_context(const Handle(Standard_Type) & type) {
  return type->SubType(STANDARD_TYPE(StepRepr_GlobalUnitAssignedContext)) ||
         type->SubType(
             STANDARD_TYPE(StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx)) ||
         type->SubType(
             STANDARD_TYPE(StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext));
}

// Zero when the unit is not a length. A conversion names another unit; damaged files may make a
// circle of them.
double millimetres_of(const Handle(Standard_Transient) & unit, int depth = 0) {
  const auto si = Handle(StepBasic_SiUnitAndLengthUnit)::DownCast(unit);
  if (!si.IsNull()) {
    if (!si->HasPrefix()) return 1000.0;
    return si->Prefix() == StepBasic_spMilli
               ? 1.0
               : 1000.0 * STEPConstruct_UnitContext::ConvertSiPrefix(si->Prefix());
  }
  const auto converted = Handle(StepBasic_ConversionBasedUnitAndLengthUnit)::DownCast(unit);
  if (converted.IsNull() || converted->ConversionFactor().IsNull() || depth > 4) return 0.0;
  const auto& measure = converted->ConversionFactor();
  return measure->ValueComponent() * millimetres_of(measure->UnitComponent().Value(), depth + 1);
}

}  // namespace

LengthUnit step_unit(const StepData_StepModel& model, std::vector<std::string>& notices) {
  LengthUnit found;
  bool mixed = false;
  std::unordered_map<const Standard_Type*, bool> may_have;
  for (int k = 1; k <= model.NbEntities(); ++k) {
    const Handle(Standard_Transient) entity = model.Value(k);
    const Handle(Standard_Type)& type = entity->DynamicType();
    const auto [known, fresh] = may_have.try_emplace(type.get(), false);
    if (fresh) known->second = may_have_context(type);
    if (!known->second) continue;
    const Context context = context_of(entity);
    if (context.IsNull() || context->Units().IsNull()) continue;
    for (int j = 1; j <= context->NbUnits(); ++j) {
      const double millimetres = millimetres_of(context->UnitsValue(j));
      if (!(millimetres > 0.0)) continue;
      const LengthUnit unit = unit_of_millimetres(millimetres);
      if (!found.stated) found = unit;
      mixed = mixed || unit.name != found.name;
    }
  }
  if (!found.stated) notices.push_back("states no length unit; taken as mm");
  if (mixed) notices.push_back("parts have different length units; all are given in " + found.name);
  return found;
}

}  // namespace isochor::internal
