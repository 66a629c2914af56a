#include "isochor/step/file_surface.h"

#include <StepGeom_BSplineSurfaceWithKnots.hxx>
#include <StepGeom_BSplineSurfaceWithKnotsAndRationalBSplineSurface.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TColStd_HArray1OfInteger.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TColStd_HArray2OfReal.hxx>
#include <TopoDS.hxx>
#include <XSControl_TransferReader.hxx>

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

}  // namespace isochor::internal
