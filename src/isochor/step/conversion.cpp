#include "isochor/step/conversion.h"

#include <BndLib_Add2dCurve.hxx>
#include <Bnd_Box2d.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <GeomAbs_CurveType.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Plane.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/bspline/cut_box.h"
#include "isochor/step/occt_surface.h"

namespace isochor::internal {
namespace {

constexpr int kCubic = 3;
constexpr int kSamples = 9;
// Trimmed faces get this much more surface on each side, relative to their size.
constexpr double kMargin = 0.05;

// The box of the face's parameter curves; void when there is none.
Bnd_Box2d curve_box(const FaceRecord& face) {
  Bnd_Box2d box;
  for (const FaceLoop& loop : face.loops) {
    for (const EdgeUse& use : loop.uses) {
      if (use.curve.IsNull()) continue;
      BndLib_Add2dCurve::Add(Geom2dAdaptor_Curve(use.curve), use.first, use.last, 0.0, box);
    }
  }
  return box;
}

void widen(double& low, double& high) {
  const double margin = kMargin * (high - low);
  low -= margin;
  high += margin;
}

// Knots and multiplicities of one cubic span.
struct Span {
  TColStd_Array1OfReal knots{1, 2};
  TColStd_Array1OfInteger multiplicities{1, 2};
  Span(double begin, double end) {
    knots(1) = begin;
    knots(2) = end;
    multiplicities.Init(kCubic + 1);
  }
};

double third(double begin, double end, int k) {
  return k == kCubic ? end : begin + (end - begin) * k / kCubic;
}

Handle(Geom_BSplineSurface) of_plane(const Handle(Geom_Plane) & plane, const UvBox& box) {
  TColgp_Array2OfPnt poles(1, kCubic + 1, 1, kCubic + 1);
  for (int i = 0; i <= kCubic; ++i) {
    for (int j = 0; j <= kCubic; ++j) {
      poles(i + 1, j + 1) =
          plane->Value(third(box.u_min, box.u_max, i), third(box.v_min, box.v_max, j));
    }
  }
  const Span u(box.u_min, box.u_max), v(box.v_min, box.v_max);
  return new Geom_BSplineSurface(poles, u.knots, v.knots, u.multiplicities, v.multiplicities,
                                 kCubic, kCubic);
}

Handle(Geom_BSplineSurface)
    of_extrusion(const Handle(Geom_SurfaceOfLinearExtrusion) & surface, const UvBox& box) {
  Handle(Geom_Curve) basis = surface->BasisCurve();
  const GeomAbs_CurveType type = GeomAdaptor_Curve(basis).GetType();
  if (type != GeomAbs_BSplineCurve && type != GeomAbs_BezierCurve && type != GeomAbs_Line) {
    return {};
  }
  if (type == GeomAbs_Line) basis = new Geom_TrimmedCurve(basis, box.u_min, box.u_max);
  const Handle(Geom_BSplineCurve) curve = GeomConvert::CurveToBSplineCurve(basis);
  if (curve->IsPeriodic()) curve->SetNotPeriodic();
  if (curve->Degree() < kCubic) curve->IncreaseDegree(kCubic);
  TColgp_Array2OfPnt poles(1, curve->NbPoles(), 1, kCubic + 1);
  TColStd_Array2OfReal weights(1, curve->NbPoles(), 1, kCubic + 1);
  for (int i = 1; i <= curve->NbPoles(); ++i) {
    for (int j = 0; j <= kCubic; ++j) {
      const gp_Vec along(surface->Direction());
      poles(i, j + 1) = curve->Pole(i).Translated(along * third(box.v_min, box.v_max, j));
      weights(i, j + 1) = curve->Weight(i);
    }
  }
  TColStd_Array1OfReal knots(1, curve->NbKnots());
  TColStd_Array1OfInteger multiplicities(1, curve->NbKnots());
  curve->Knots(knots);
  curve->Multiplicities(multiplicities);
  const Span v(box.v_min, box.v_max);
  if (!curve->IsRational()) {
    return new Geom_BSplineSurface(poles, knots, v.knots, multiplicities, v.multiplicities,
                                   curve->Degree(), kCubic);
  }
  return new Geom_BSplineSurface(poles, weights, knots, v.knots, multiplicities, v.multiplicities,
                                 curve->Degree(), kCubic);
}

double largest_deviation(const Geom_Surface& a, const Geom_Surface& b, const UvBox& box) {
  double deviation = 0.0;
  for (int i = 0; i <= kSamples; ++i) {
    for (int j = 0; j <= kSamples; ++j) {
      const double u = box.u_min + (box.u_max - box.u_min) * i / kSamples;
      const double v = box.v_min + (box.v_max - box.v_min) * j / kSamples;
      deviation = std::max(deviation, a.Value(u, v).Distance(b.Value(u, v)));
    }
  }
  return deviation;
}

// The box of a face's parameter curves, its sides moved to the knots they are meant to be. Nothing
// for boxes that reach beyond the domain (across a seam).
std::optional<UvBox> box_on_knots(const FaceRecord& face, const Surface& surface) {
  std::vector<double> u, v;
  for (const FaceLoop& loop : face.loops) {
    for (const EdgeUse& use : loop.uses) {
      if (use.curve.IsNull()) return std::nullopt;
      for (const gp_Pnt2d& at : {use.start(), use.finish()}) {
        u.push_back(at.X());
        v.push_back(at.Y());
      }
    }
  }
  if (u.empty()) return std::nullopt;
  const auto on_knot = [](double t, const KnotVector& knots) {
    for (double knot : knots.breaks()) {
      if (std::abs(t - knot) <= kSideNoise * (knots.end() - knots.begin())) return knot;
    }
    return t;
  };
  const auto [u_low, u_high] = std::minmax_element(u.begin(), u.end());
  const auto [v_low, v_high] = std::minmax_element(v.begin(), v.end());
  const UvBox box{on_knot(*u_low, surface.u_knots()), on_knot(*u_high, surface.u_knots()),
                  on_knot(*v_low, surface.v_knots()), on_knot(*v_high, surface.v_knots())};
  const auto fits = [](double low, double high, const KnotVector& knots) {
    return knots.begin() <= low && high <= knots.end() &&
           high - low > kSideSlack * (knots.end() - knots.begin());
  };
  if (!fits(box.u_min, box.u_max, surface.u_knots()) ||
      !fits(box.v_min, box.v_max, surface.v_knots())) {
    return std::nullopt;
  }
  return box;
}

bool has_circles(const std::string& kind) {
  return kind == "cylinder" || kind == "cone" || kind == "sphere" || kind == "torus" ||
         kind == "surface of revolution" || kind == "extruded surface";
}

}  // namespace

Conversion convert_face(const FaceRecord& face, double diagonal) {
  if (face.surface.bspline) return {{}, "it is a B-spline face already"};
  if (face.surface.geometry.IsNull() || face.loops.empty()) return {{}, "it has no boundary"};
  if (!face.shared.empty()) return {{}, face.shared};
  if (!moved_rigidly(face.face)) return {{}, "its part is mirrored or scaled by an assembly"};
  const Bnd_Box2d curves = curve_box(face);
  if (curves.IsVoid() || curves.IsOpenXmin() || curves.IsOpenXmax())
    return {{}, "it has no extent"};
  UvBox box;
  curves.Get(box.u_min, box.v_min, box.u_max, box.v_max);
  if (!(box.u_max > box.u_min) || !(box.v_max > box.v_min)) return {{}, "it has no extent"};
  const auto plane = Handle(Geom_Plane)::DownCast(face.surface.geometry);
  const auto extrusion = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(face.surface.geometry);
  if (face.trim.kind != TrimKind::kIsoBox && face.trim.kind != TrimKind::kNatural) {
    if (!plane.IsNull()) widen(box.u_min, box.u_max);
    widen(box.v_min, box.v_max);
  }
  Conversion result;
  try {
    if (!plane.IsNull()) result.surface = of_plane(plane, box);
    if (!extrusion.IsNull()) result.surface = of_extrusion(extrusion, box);
  } catch (const Standard_Failure&) {  // faces too slender for distinct knots
  }
  if (result.surface.IsNull()) {
    result.refusal = has_circles(face.surface.kind)
                         ? "no B-spline runs along its circles with the same parameters"
                         : "there is no exact B-spline form of it";
    return result;
  }
  const double deviation = largest_deviation(*face.surface.geometry, *result.surface, box);
  if (!(deviation <= kSameSurface * diagonal)) {
    result.surface.Nullify();
    result.refusal = "its B-spline form would be " + std::to_string(deviation) + " off";
  }
  return result;
}

std::optional<Surface> cut_like(const Surface& whole, const Surface& edited) {
  const KnotVector &u = whole.u_knots(), &v = whole.v_knots();
  const UvBox box{edited.u_knots().begin(), edited.u_knots().end(), edited.v_knots().begin(),
                  edited.v_knots().end()};
  const bool inside = u.begin() <= box.u_min && box.u_max <= u.end() && v.begin() <= box.v_min &&
                      box.v_max <= v.end();
  const bool same = u.begin() == box.u_min && box.u_max == u.end() && v.begin() == box.v_min &&
                    box.v_max == v.end();
  if (!inside || same) return std::nullopt;
  return cut_box(whole, box);
}

void cut_iso_boxes(BrepTable& table) {
  const double distance = kSideDistance * table.diagonal;
  for (FaceRecord& face : table.faces) {
    if (!face.surface.surface || face.trim.kind != TrimKind::kIsoBox) continue;
    const Surface& whole = *face.surface.surface;
    const std::optional<UvBox> box = box_on_knots(face, whole);
    if (!box) continue;
    const Surface part = cut_box(whole, *box);
    const Handle(Geom_BSplineSurface) geometry = to_occt(part);
    const FaceTrim trim = classify_trim(geometry, face.loops, distance);
    if (trim.kind != TrimKind::kNatural) continue;
    face.surface.surface = part;
    face.surface.geometry = geometry;
    face.trim = trim;
  }
}

std::string convert_faces(BrepTable& table, const std::vector<int>& faces) {
  for (int f : faces) {
    ISOCHOR_REQUIRE(f >= 0 && f < static_cast<int>(table.faces.size()), f, table.faces.size());
    FaceRecord& face = table.faces[static_cast<size_t>(f)];
    if (face.surface.surface) continue;
    const Conversion conversion = convert_face(face, table.diagonal);
    if (conversion.surface.IsNull()) {
      return table.label(f) + " cannot be turned into a B-spline face: " + conversion.refusal;
    }
    const std::string kind = face.surface.kind;
    face.surface = describe_surface(conversion.surface);
    face.surface.kind += " (was " + kind + ")";
    face.trim = classify_trim(face.surface.geometry, face.loops, kSideDistance * table.diagonal);
  }
  return "";
}

}  // namespace isochor::internal
