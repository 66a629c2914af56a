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

#include "isochor/step/entity_index.h"

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
  // Weights that are all equal cancel; OpenCASCADE leaves them out.
  const auto differs = [&](double w) { return w != weights.front(); };
  if (std::none_of(weights.begin(), weights.end(), differs)) weights.clear();
  return Surface(u_knots, v_knots, std::move(poles), std::move(weights));
}

// Parameters mean the same; knots beyond the ends may differ, as they do when a periodic surface is
// written.
bool same_domain(const KnotVector& a, const KnotVector& b) {
  return a.degree() == b.degree() && a.begin() == b.begin() && a.end() == b.end();
}

// Parameters mean the same on what the reader made of a surface.
bool same_range(const Geom_BSplineSurface& made, const Surface& stated) {
  double u0 = 0.0, u1 = 0.0, v0 = 0.0, v1 = 0.0;
  made.Bounds(u0, u1, v0, v1);
  const KnotVector &u = stated.u_knots(), &v = stated.v_knots();
  return made.UDegree() == u.degree() && made.VDegree() == v.degree() && u0 == u.begin() &&
         u1 == u.end() && v0 == v.begin() && v1 == v.end();
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

std::optional<Surface> surface_of_entity(const Handle(Standard_Transient) & entity) {
  const auto step_face = Handle(StepShape_FaceSurface)::DownCast(entity);
  auto surface = Handle(StepGeom_Surface)::DownCast(entity);
  if (!step_face.IsNull()) surface = step_face->FaceGeometry();
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

}  // namespace

std::optional<Surface> file_surface(const Document& document, int k) {
  return surface_of_entity(EntityIndex(document).entity(document.face(k)));
}

FileSurfaces changed_by_reader(const Document& document) {
  FileSurfaces changed;
  const EntityIndex index(document);
  for (int k = 0; k < document.face_count(); ++k) {
    TopLoc_Location ignored;
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(document.face(k), ignored);
    const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface);
    if (spline.IsNull() || (!spline->IsUPeriodic() && !spline->IsVPeriodic())) continue;
    const auto in_file = surface_of_entity(index.entity(document.face(k)));
    if (in_file && same_range(*spline, *in_file)) changed.emplace(k, *in_file);
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
