#include "isochor/step/file_surface.h"

#include <BRep_Tool.hxx>
#include <Geom_BSplineSurface.hxx>
#include <STEPConstruct.hxx>
#include <StepGeom_BSplineSurfaceWithKnots.hxx>
#include <StepGeom_BSplineSurfaceWithKnotsAndRationalBSplineSurface.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TColStd_HArray1OfInteger.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TColStd_HArray2OfReal.hxx>
#include <TopoDS.hxx>
#include <Transfer_FinderProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_TransferWriter.hxx>
#include <algorithm>

namespace isochor::internal {
namespace {

template <typename Spline>
std::optional<Surface> surface_of(const Spline& spline, std::vector<double> weights) {
  const auto flat = [](const Handle(TColStd_HArray1OfReal) & knots,
                       const Handle(TColStd_HArray1OfInteger) & counts) {
    std::vector<double> values;
    for (int k = knots->Lower(); k <= knots->Upper(); ++k) {
      values.insert(values.end(), static_cast<size_t>(std::max(0, counts->Value(k))),
                    knots->Value(k));
    }
    return values;
  };
  const auto u = flat(spline->UKnots(), spline->UMultiplicities());
  const auto v = flat(spline->VKnots(), spline->VMultiplicities());
  const int du = spline->UDegree(), dv = spline->VDegree();
  if (!KnotVector::defect(du, u).empty() || !KnotVector::defect(dv, v).empty()) {
    return std::nullopt;
  }
  std::vector<Vec3> poles;
  for (int i = 1; i <= spline->NbControlPointsListI(); ++i) {
    for (int j = 1; j <= spline->NbControlPointsListJ(); ++j) {
      const Handle(StepGeom_CartesianPoint) p = spline->ControlPointsListValue(i, j);
      if (p.IsNull() || p->NbCoordinates() != 3) return std::nullopt;
      poles.emplace_back(p->CoordinatesValue(1), p->CoordinatesValue(2), p->CoordinatesValue(3));
    }
  }
  const KnotVector u_knots(du, u), v_knots(dv, v);
  const size_t size = static_cast<size_t>(u_knots.size()) * static_cast<size_t>(v_knots.size());
  if (poles.size() != size || (!weights.empty() && weights.size() != size)) return std::nullopt;
  return Surface(u_knots, v_knots, std::move(poles), std::move(weights));
}

// Parameters mean the same; knots beyond the ends may differ, as they do when a periodic surface is
// written.
bool same_domain(const KnotVector& a, const KnotVector& b) {
  return a.degree() == b.degree() && a.begin() == b.begin() && a.end() == b.end();
}

std::vector<double> all_breaks(const KnotVector& knots) {
  std::vector<double> values = knots.knots();
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

Handle(TColStd_HArray1OfReal) distinct_knots(const KnotVector& knots) {
  const auto values = all_breaks(knots);
  const Handle(TColStd_HArray1OfReal) array =
      new TColStd_HArray1OfReal(1, static_cast<int>(values.size()));
  for (int k = 1; k <= array->Length(); ++k) {
    array->SetValue(k, values[static_cast<size_t>(k) - 1]);
  }
  return array;
}

Handle(TColStd_HArray1OfInteger) multiplicities(const KnotVector& knots) {
  const auto values = all_breaks(knots);
  const Handle(TColStd_HArray1OfInteger) array =
      new TColStd_HArray1OfInteger(1, static_cast<int>(values.size()));
  for (int k = 1; k <= array->Length(); ++k) {
    array->SetValue(k, knots.multiplicity(values[static_cast<size_t>(k) - 1]));
  }
  return array;
}

// Overwrites points and knots of an entity that has the same sizes.
template <typename Spline>
bool overwrite(const Spline& spline, const Surface& surface) {
  const auto old = surface_of(spline, {});
  if (!old || old->u_size() != surface.u_size() || old->v_size() != surface.v_size()) return false;
  if (!same_domain(old->u_knots(), surface.u_knots()) ||
      !same_domain(old->v_knots(), surface.v_knots())) {
    return false;
  }
  spline->SetUKnots(distinct_knots(surface.u_knots()));
  spline->SetUMultiplicities(multiplicities(surface.u_knots()));
  spline->SetVKnots(distinct_knots(surface.v_knots()));
  spline->SetVMultiplicities(multiplicities(surface.v_knots()));
  for (int i = 0; i < surface.u_size(); ++i) {
    for (int j = 0; j < surface.v_size(); ++j) {
      const Vec3& p = surface.pole(i, j);
      const Handle(StepGeom_CartesianPoint) point = spline->ControlPointsListValue(i + 1, j + 1);
      point->Init3D(point->Name(), p.x(), p.y(), p.z());
    }
  }
  return true;
}

}  // namespace

std::optional<Surface> file_surface(const Document& document, int k) {
  if (document.format != FileFormat::kStep || document.session.IsNull()) return std::nullopt;
  const Handle(XSControl_TransferReader) reader = document.session->TransferReader();
  const TopoDS_Face face = document.face(k);
  Handle(Standard_Transient) entity = reader->EntityFromShapeResult(face, 1);
  if (entity.IsNull()) {
    entity = reader->EntityFromShapeResult(face.Located(TopLoc_Location()), 1);
  }
  const auto step_face = Handle(StepShape_FaceSurface)::DownCast(entity);
  if (step_face.IsNull()) return std::nullopt;
  const Handle(StepGeom_Surface) surface = step_face->FaceGeometry();
  const auto plain = Handle(StepGeom_BSplineSurfaceWithKnots)::DownCast(surface);
  if (!plain.IsNull()) return surface_of(plain, {});
  const auto rational =
      Handle(StepGeom_BSplineSurfaceWithKnotsAndRationalBSplineSurface)::DownCast(surface);
  if (rational.IsNull() || rational->WeightsData().IsNull()) return std::nullopt;
  std::vector<double> weights;
  for (int i = 1; i <= rational->NbWeightsDataI(); ++i) {
    for (int j = 1; j <= rational->NbWeightsDataJ(); ++j) {
      weights.push_back(rational->WeightsDataValue(i, j));
      if (!(weights.back() > 0.0)) return std::nullopt;
    }
  }
  return surface_of(rational, std::move(weights));
}

FileSurfaces changed_by_reader(const Document& document) {
  FileSurfaces changed;
  for (int k = 0; k < document.face_count(); ++k) {
    TopLoc_Location ignored;
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(document.face(k), ignored);
    const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface);
    if (spline.IsNull() || (!spline->IsUPeriodic() && !spline->IsVPeriodic())) continue;
    const auto in_file = file_surface(document, k);
    if (in_file) changed.emplace(k, *in_file);
  }
  return changed;
}

bool restore_numbers(const Handle(XSControl_WorkSession) & writer, const TopoDS_Face& face,
                     const Surface& surface) {
  const Handle(Transfer_FinderProcess) finder = writer->TransferWriter()->FinderProcess();
  Handle(StepRepr_RepresentationItem) item = STEPConstruct::FindEntity(finder, face);
  if (item.IsNull()) {
    item = STEPConstruct::FindEntity(finder, face.Located(TopLoc_Location()));
  }
  const auto step_face = Handle(StepShape_FaceSurface)::DownCast(item);
  if (step_face.IsNull()) return false;
  const auto plain = Handle(StepGeom_BSplineSurfaceWithKnots)::DownCast(step_face->FaceGeometry());
  if (!plain.IsNull()) return !surface.rational() && overwrite(plain, surface);
  const auto rational = Handle(StepGeom_BSplineSurfaceWithKnotsAndRationalBSplineSurface)::DownCast(
      step_face->FaceGeometry());
  if (rational.IsNull() || !surface.rational() || !overwrite(rational, surface)) return false;
  for (int i = 0; i < surface.u_size(); ++i) {
    for (int j = 0; j < surface.v_size(); ++j) {
      rational->WeightsData()->SetValue(i + 1, j + 1, surface.weights()[surface.index(i, j)]);
    }
  }
  return true;
}

}  // namespace isochor::internal
