#include "isochor/step/face_patches.h"

#include <BRep_Tool.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <TopLoc_Location.hxx>
#include <cmath>
#include <vector>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/step/occt_surface.h"

namespace isochor::internal {
namespace {

std::string name_of(GeomAbs_SurfaceType type) {
  switch (type) {
    case GeomAbs_Plane:
      return "plane";
    case GeomAbs_Cylinder:
      return "cylinder";
    case GeomAbs_Cone:
      return "cone";
    case GeomAbs_Sphere:
      return "sphere";
    case GeomAbs_Torus:
      return "torus";
    case GeomAbs_SurfaceOfRevolution:
      return "surface of revolution";
    case GeomAbs_SurfaceOfExtrusion:
      return "extruded surface";
    case GeomAbs_OffsetSurface:
      return "offset surface";
    default:
      return "surface of an unknown kind";
  }
}

Handle(Geom_Surface) unwrapped(Handle(Geom_Surface) surface) {
  for (;;) {
    const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
    if (trimmed.IsNull()) return surface;
    surface = trimmed->BasisSurface();
  }
}

// Without periodic directions: unclamped knots, and as many poles more as wrap around.
Handle(Geom_BSplineSurface) opened(const Handle(Geom_BSplineSurface) & surface) {
  if (!surface->IsUPeriodic() && !surface->IsVPeriodic()) return surface;
  const auto copy = Handle(Geom_BSplineSurface)::DownCast(surface->Copy());
  if (copy->IsUPeriodic()) copy->SetUNotPeriodic();
  if (copy->IsVPeriodic()) copy->SetVNotPeriodic();
  return copy;
}

std::string weight_defect(const Handle(Geom_BSplineSurface) & surface) {
  if (!surface->IsURational() && !surface->IsVRational()) return "";
  for (int i = 1; i <= surface->NbUPoles(); ++i) {
    for (int j = 1; j <= surface->NbVPoles(); ++j) {
      const double w = surface->Weight(i, j);
      if (!(w > 0.0) || !std::isfinite(w))
        return "weight " + std::to_string(w) + " is not positive";
    }
  }
  return "";
}

std::string value_defect(const Handle(Geom_BSplineSurface) & surface) {
  for (int i = 1; i <= surface->NbUPoles(); ++i) {
    for (int j = 1; j <= surface->NbVPoles(); ++j) {
      const gp_Pnt p = surface->Pole(i, j);
      if (!std::isfinite(p.X() + p.Y() + p.Z())) return "a pole is not a finite point";
    }
  }
  return weight_defect(surface);
}

}  // namespace

FaceSurface describe_surface(const Handle(Geom_Surface) & surface) {
  FaceSurface result;
  if (surface.IsNull()) {
    result.kind = "no surface";
    result.refusal = "the file gives it no surface";
    return result;
  }
  result.geometry = unwrapped(surface);
  const auto bezier = Handle(Geom_BezierSurface)::DownCast(result.geometry);
  auto spline = Handle(Geom_BSplineSurface)::DownCast(result.geometry);
  if (!bezier.IsNull()) spline = GeomConvert::SurfaceToBSplineSurface(bezier);
  if (spline.IsNull()) {
    result.kind = name_of(GeomAdaptor_Surface(result.geometry).GetType());
    result.refusal = "it is a " + result.kind + ", not a B-spline surface";
    return result;
  }
  result.bspline = true;
  result.rational = spline->IsURational() || spline->IsVRational();
  result.kind = std::string(result.rational ? "rational " : "") +
                (bezier.IsNull() ? "B-spline " : "Bezier ") + std::to_string(spline->UDegree()) +
                "x" + std::to_string(spline->VDegree());
  result.geometry = spline;
  result.refusal = value_defect(spline);
  if (!result.refusal.empty()) return result;
  try {
    spline = opened(spline);
    result.surface = from_occt(*spline);
    result.geometry = spline;
  } catch (const InputError& error) {
    result.refusal = "its knots: " + error.reason();
  }
  return result;
}

bool moved_rigidly(const TopoDS_Face& face) {
  TopLoc_Location location;
  BRep_Tool::Surface(face, location);
  const gp_Trsf& move = location.Transformation();
  return !move.IsNegative() && std::abs(move.ScaleFactor() - 1.0) <= kSameSurface;
}

FaceSurface face_surface(const TopoDS_Face& face, const Surface* stated) {
  TopLoc_Location location;
  Handle(Geom_Surface) own = BRep_Tool::Surface(face, location);
  if (stated != nullptr) own = to_occt(*stated);
  FaceSurface result = describe_surface(own);
  if (location.IsIdentity() || result.geometry.IsNull()) return result;
  // Opened first, moved then: whoever writes recognises poles that were not edited by doing the
  // same steps in the same order.
  const gp_Trsf& move = location.Transformation();
  result.geometry = Handle(Geom_Surface)::DownCast(result.geometry->Transformed(move));
  if (!result.surface) return result;
  if (!moved_rigidly(face)) {
    result.surface.reset();
    result.refusal = "its part is mirrored or scaled by an assembly";
    return result;
  }
  result.surface = from_occt(*Handle(Geom_BSplineSurface)::DownCast(result.geometry));
  return result;
}

}  // namespace isochor::internal
