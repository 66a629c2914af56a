#include "isochor/step/occt_surface.h"

#include <BRep_Tool.hxx>
#include <GeomConvert.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopLoc_Location.hxx>

#include "isochor/base/error.h"

namespace isochor::internal {
namespace {

// Distinct knots and their multiplicities, as OpenCASCADE wants them.
struct Multiplied {
  TColStd_Array1OfReal knots;
  TColStd_Array1OfInteger multiplicities;

  explicit Multiplied(const KnotVector& flat)
      : knots(1, distinct(flat)), multiplicities(1, knots.Length()) {
    int at = 0;
    const auto& values = flat.knots();
    for (size_t k = 0; k < values.size(); ++k) {
      if (k > 0 && values[k] == values[k - 1]) {
        ++multiplicities(at);
      } else {
        knots(++at) = values[k];
        multiplicities(at) = 1;
      }
    }
  }

 private:
  static int distinct(const KnotVector& flat) {
    int count = 1;
    const auto& values = flat.knots();
    for (size_t k = 1; k < values.size(); ++k) count += values[k] != values[k - 1] ? 1 : 0;
    return count;
  }
};

KnotVector flat_knots(const TColStd_Array1OfReal& knots, const TColStd_Array1OfInteger& counts,
                      int degree) {
  std::vector<double> flat;
  for (int k = knots.Lower(); k <= knots.Upper(); ++k) {
    flat.insert(flat.end(), static_cast<size_t>(counts(k)), knots(k));
  }
  const std::string defect = KnotVector::defect(degree, flat);
  if (!defect.empty()) throw InputError("", "", defect);
  return KnotVector(degree, std::move(flat));
}

}  // namespace

Handle(Geom_BSplineSurface) to_occt(const Surface& surface) {
  const int nu = surface.u_size(), nv = surface.v_size();
  TColgp_Array2OfPnt poles(1, nu, 1, nv);
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      const Vec3& p = surface.pole(i, j);
      poles(i + 1, j + 1) = gp_Pnt(p.x(), p.y(), p.z());
    }
  }
  const Multiplied u(surface.u_knots()), v(surface.v_knots());
  const int du = surface.u_knots().degree(), dv = surface.v_knots().degree();
  if (!surface.rational()) {
    return new Geom_BSplineSurface(poles, u.knots, v.knots, u.multiplicities, v.multiplicities, du,
                                   dv);
  }
  TColStd_Array2OfReal weights(1, nu, 1, nv);
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) weights(i + 1, j + 1) = surface.weights()[surface.index(i, j)];
  }
  return new Geom_BSplineSurface(poles, weights, u.knots, v.knots, u.multiplicities,
                                 v.multiplicities, du, dv);
}

Surface from_occt(const Geom_BSplineSurface& surface) {
  ISOCHOR_REQUIRE(!surface.IsUPeriodic() && !surface.IsVPeriodic());
  const bool rational = surface.IsURational() || surface.IsVRational();
  std::vector<Vec3> poles;
  std::vector<double> weights;
  for (int i = 1; i <= surface.NbUPoles(); ++i) {
    for (int j = 1; j <= surface.NbVPoles(); ++j) {
      const gp_Pnt p = surface.Pole(i, j);
      poles.emplace_back(p.X(), p.Y(), p.Z());
      if (rational) weights.push_back(surface.Weight(i, j));
    }
  }
  return Surface(flat_knots(surface.UKnots(), surface.UMultiplicities(), surface.UDegree()),
                 flat_knots(surface.VKnots(), surface.VMultiplicities(), surface.VDegree()),
                 std::move(poles), std::move(weights));
}

Handle(Geom_BSplineSurface) plain_bspline(const TopoDS_Face& face) {
  TopLoc_Location ignored;
  Handle(Geom_Surface) surface = BRep_Tool::Surface(face, ignored);
  const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
  if (!trimmed.IsNull()) surface = trimmed->BasisSurface();
  Handle(Geom_BSplineSurface) spline;
  if (surface->IsKind(STANDARD_TYPE(Geom_BezierSurface))) {
    spline = GeomConvert::SurfaceToBSplineSurface(surface);
  } else if (surface->IsKind(STANDARD_TYPE(Geom_BSplineSurface))) {
    spline = Handle(Geom_BSplineSurface)::DownCast(surface->Copy());
  }
  if (spline.IsNull()) return spline;
  if (spline->IsUPeriodic()) spline->SetUNotPeriodic();
  if (spline->IsVPeriodic()) spline->SetVNotPeriodic();
  return spline;
}

}  // namespace isochor::internal
