#include "isochor/step/entity_index.h"

#include <StepData_StepModel.hxx>
#include <StepGeom_Surface.hxx>
#include <StepShape_EdgeCurve.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_VertexPoint.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>

namespace isochor::internal {
namespace {

TopAbs_ShapeEnum kind_of(const Handle(Standard_Transient) & entity) {
  if (entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface))) return TopAbs_FACE;
  if (entity->IsKind(STANDARD_TYPE(StepGeom_Surface))) return TopAbs_FACE;
  if (entity->IsKind(STANDARD_TYPE(StepShape_EdgeCurve))) return TopAbs_EDGE;
  if (entity->IsKind(STANDARD_TYPE(StepShape_VertexPoint))) return TopAbs_VERTEX;
  return TopAbs_SHAPE;
}

}  // namespace

EntityIndex::EntityIndex(const Document& document) {
  if (document.format != FileFormat::kStep || document.session.IsNull()) return;
  const Handle(XSControl_TransferReader) reader = document.session->TransferReader();
  const auto model = Handle(StepData_StepModel)::DownCast(document.session->Model());
  if (reader.IsNull() || reader->TransientProcess().IsNull() || model.IsNull()) return;
  const Handle(Transfer_TransientProcess) process = reader->TransientProcess();
  for (int k = 1; k <= process->NbMapped(); ++k) {
    const Handle(Standard_Transient) entity = process->Mapped(k);
    if (entity.IsNull()) continue;
    const TopAbs_ShapeEnum kind = kind_of(entity);
    if (kind == TopAbs_SHAPE) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, entity);
    if (shape.IsNull() || shape.ShapeType() != kind) continue;
    const int number = model->IdentLabel(entity);
    by_shape_.emplace(shape.TShape().get(),
                      Entry{entity, number > 0 ? static_cast<std::uint64_t>(number) : 0});
  }
  for (TopTools_DataMapOfShapeShape::Iterator it(document.origins); it.More(); it.Next()) {
    const auto found = by_shape_.find(it.Value().TShape().get());
    if (found == by_shape_.end()) continue;
    const Entry own = found->second;
    by_shape_.emplace(it.Key().TShape().get(), own);
  }
}

Handle(Standard_Transient) EntityIndex::entity(const TopoDS_Shape& shape) const {
  const auto found = by_shape_.find(shape.TShape().get());
  return found == by_shape_.end() ? Handle(Standard_Transient)() : found->second.entity;
}

std::uint64_t EntityIndex::number(const TopoDS_Shape& shape) const {
  const auto found = by_shape_.find(shape.TShape().get());
  return found == by_shape_.end() ? 0 : found->second.number;
}

}  // namespace isochor::internal
