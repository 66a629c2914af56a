#include "isochor/step/written_torus.h"

#include <BRep_Tool.hxx>
#include <GeomToStep_MakeToroidalSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <STEPConstruct.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_Axis1Placement.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepGeom_Direction.hxx>
#include <StepGeom_Pcurve.hxx>
#include <StepGeom_SurfaceOfRevolution.hxx>
#include <StepGeom_ToroidalSurface.hxx>
#include <StepShape_FaceSurface.hxx>
#include <Transfer_FinderProcess.hxx>
#include <XSControl_TransferWriter.hxx>
#include <set>
#include <utility>
#include <vector>

namespace isochor::internal {
namespace {

using Revolution = StepGeom_SurfaceOfRevolution;
using Torus = StepGeom_ToroidalSurface;

// The torus under a face when it meets itself, with right-handed axes as STEP wants them.
Handle(Geom_ToroidalSurface) spindle(const Handle(Geom_Surface) & surface) {
  Handle(Geom_Surface) plain = surface;
  const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
  if (!trimmed.IsNull()) plain = trimmed->BasisSurface();
  auto torus = Handle(Geom_ToroidalSurface)::DownCast(plain);
  if (torus.IsNull() || torus->MajorRadius() >= torus->MinorRadius()) return {};
  if (torus->Position().Direct()) return torus;
  torus = Handle(Geom_ToroidalSurface)::DownCast(torus->Copy());
  torus->UReverse();
  return torus;
}

bool same_axis(const Geom_ToroidalSurface& torus, const Revolution& revolution) {
  const Handle(StepGeom_Axis1Placement) axis = revolution.AxisPosition();
  if (axis.IsNull() || axis->Location().IsNull() || !axis->HasAxis()) return false;
  const gp_Pnt place = torus.Position().Location();
  const gp_Dir along = torus.Position().Direction();
  for (int k = 1; k <= 3; ++k) {
    if (axis->Location()->CoordinatesValue(k) != place.Coord(k)) return false;
    if (axis->Axis()->DirectionRatiosValue(k) != along.Coord(k)) return false;
  }
  return true;
}

// A part may be written where it stands or in coordinates of its own.
Handle(Torus) torus_of(const TopoDS_Face& face, const Revolution& revolution) {
  TopLoc_Location ignored;
  for (const auto& surface : {BRep_Tool::Surface(face), BRep_Tool::Surface(face, ignored)}) {
    const auto torus = spindle(surface);
    if (!torus.IsNull() && same_axis(*torus, revolution)) {
      return GeomToStep_MakeToroidalSurface(torus).Value();
    }
  }
  return {};
}

Handle(StepShape_FaceSurface)
    written_face(const Handle(Transfer_FinderProcess) & finder, const TopoDS_Face& face) {
  Handle(StepRepr_RepresentationItem) item = STEPConstruct::FindEntity(finder, face);
  if (item.IsNull()) item = STEPConstruct::FindEntity(finder, face.Located(TopLoc_Location()));
  return Handle(StepShape_FaceSurface)::DownCast(item);
}

// In face order: the same shape always gives the same file.
using Replacements = std::vector<std::pair<Handle(Revolution), Handle(Torus)>>;
using Entities = std::set<Handle(Standard_Transient)>;

// An entity and all that it refers to.
void collect(const Interface_Graph& graph, const Handle(Standard_Transient) & entity,
             Entities& found) {
  if (!found.insert(entity).second) return;
  Interface_EntityIterator parts = graph.Shareds(entity);
  for (parts.Start(); parts.More(); parts.Next()) collect(graph, parts.Value(), found);
}

// The model again with `replaced` in place of the surfaces and without their parts, which belong to
// them alone: the writer makes each anew.
void exchange(const Handle(StepData_StepModel) & model, const Replacements& replaced) {
  const Interface_Graph graph(model);
  Entities gone;
  for (const auto& [old, torus] : replaced) collect(graph, old, gone);
  std::vector<Handle(Standard_Transient)> kept;
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const Handle(Standard_Transient) entity = model->Value(k);
    if (gone.count(entity) == 0) kept.push_back(entity);
    const auto pcurve = Handle(StepGeom_Pcurve)::DownCast(entity);
    if (pcurve.IsNull()) continue;
    for (const auto& [old, torus] : replaced) {
      if (pcurve->BasisSurface() == old) pcurve->SetBasisSurface(torus);
    }
  }
  model->ClearEntities();
  for (const auto& entity : kept) model->AddEntity(entity);
  for (const auto& [old, torus] : replaced) model->AddWithRefs(torus);
}

}  // namespace

void restore_tori(const Handle(XSControl_WorkSession) & writer, const Document& document) {
  const Handle(Transfer_FinderProcess) finder = writer->TransferWriter()->FinderProcess();
  Replacements replaced;
  for (int k = 0; k < document.face_count(); ++k) {
    const TopoDS_Face face = document.face(k);
    TopLoc_Location ignored;
    if (spindle(BRep_Tool::Surface(face, ignored)).IsNull()) continue;
    const auto written = written_face(finder, face);
    if (written.IsNull()) continue;
    const auto revolution = Handle(Revolution)::DownCast(written->FaceGeometry());
    if (revolution.IsNull()) continue;
    const Handle(Torus) torus = torus_of(face, *revolution);
    if (torus.IsNull()) continue;
    replaced.emplace_back(revolution, torus);
    written->SetFaceGeometry(torus);
  }
  if (!replaced.empty()) exchange(Handle(StepData_StepModel)::DownCast(writer->Model()), replaced);
}

}  // namespace isochor::internal
