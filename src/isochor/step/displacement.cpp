#include "isochor/step/displacement.h"

#include <BRep_Tool.hxx>
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Curve.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Line.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/bspline/basis.h"
#include "isochor/bspline/refinement.h"
#include "isochor/step/occt_surface.h"

namespace isochor::internal {
namespace {

// Two ways to the same pole (the file's entity, OpenCASCADE's surface made clamped) differ by a few
// roundings of the coordinates; real displacements are larger. Relative to the largest coordinate.
constexpr double kNoise = 1e-13;

// Parameter curves of whole sides are written with about 1e-12 of the range. Relative to the range.
constexpr double kSameParameter = 1e-9;

// Samples along a parameter curve: no B-spline of the degrees allowed vanishes at all of them.
constexpr int kSamples = 64;
constexpr int kSamplesPerSpan = 8;
constexpr int kGapSamples = 2000;

// The curve of a moved trimming edge: spans to begin with, and at most; samples of each.
constexpr int kFirstSpans = 8;
constexpr int kMostSpans = 1024;
constexpr int kFitSamples = 3;

struct ParameterCurve {
  Handle(Geom2d_Curve) curve;
  double first = 0.0, last = 0.0;
  ParameterCurve(const TopoDS_Edge& edge, const TopoDS_Face& face) {
    curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  }
  Uv at(double fraction) const {
    const gp_Pnt2d p = curve->Value(first + fraction * (last - first));
    return {p.X(), p.Y()};
  }
};

// The knots outside the domain of a wrapped vector follow the insertion.
BandedMap map_between(const KnotVector& before, const KnotVector& after) {
  const bool wrapped = before != after && wrapped_poles(before) > 0 && wrapped_poles(after) > 0;
  return wrapped ? wrapped_insertion_map(before, after) : insertion_map(before, after);
}

Surface difference_of(const Surface& before, const Surface& after) {
  const bool same = before.u_knots() == after.u_knots() && before.v_knots() == after.v_knots();
  Surface fine = before;
  if (!same) {
    try {
      fine = refine(before, after.u_knots(), map_between(before.u_knots(), after.u_knots()),
                    after.v_knots(), map_between(before.v_knots(), after.v_knots()));
    } catch (const PreconditionError&) {
      throw InputError("", "", "its new knots are not a refinement of the old ones");
    }
  }
  if (fine.rational() != after.rational()) {
    throw InputError("", "", "its weights were added or removed");
  }
  std::vector<Vec3> poles(fine.poles().size());
  for (size_t k = 0; k < poles.size(); ++k) poles[k] = after.poles()[k] - fine.poles()[k];
  return Surface(after.u_knots(), after.v_knots(), std::move(poles), after.weights());
}

double largest_coordinate(const Surface& surface) {
  double largest = 0.0;
  for (const Vec3& p : surface.poles()) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  return largest;
}

// The poles of the iso curve of `surface` on `run`; OpenCASCADE's iso at a clamped end is the pole
// row itself.
Handle(Geom_BSplineCurve) iso_curve(const Surface& surface, const IsoRun& run) {
  const auto occt = to_occt(surface);
  const Handle(Geom_Curve) iso = run.along_v ? occt->UIso(run.constant) : occt->VIso(run.constant);
  auto curve = Handle(Geom_BSplineCurve)::DownCast(iso);
  if (run.slope == 1.0 && run.offset == 0.0) return curve;
  TColStd_Array1OfReal knots = curve->Knots();
  if (run.slope < 0.0) {
    curve->Reverse();  // knot x becomes first + last - x
    const double sum = knots.First() + knots.Last();
    knots = curve->Knots();
    for (int k = knots.Lower(); k <= knots.Upper(); ++k) {
      knots(k) = (sum - knots(k) - run.offset) / run.slope;
    }
  } else {
    for (int k = knots.Lower(); k <= knots.Upper(); ++k) {
      knots(k) = (knots(k) - run.offset) / run.slope;
    }
  }
  curve->SetKnots(knots);
  return curve;
}

bool same_basis(const Geom_BSplineCurve& a, const Geom_BSplineCurve& b) {
  if (a.IsPeriodic() || b.IsPeriodic() || a.Degree() != b.Degree() || a.NbPoles() != b.NbPoles() ||
      a.NbKnots() != b.NbKnots()) {
    return false;
  }
  const double range = std::abs(a.LastParameter() - a.FirstParameter());
  for (int k = 1; k <= a.NbKnots(); ++k) {
    if (a.Multiplicity(k) != b.Multiplicity(k)) return false;
    if (std::abs(a.Knot(k) - b.Knot(k)) > kNoise * range) return false;
  }
  for (int k = 1; k <= a.NbPoles(); ++k) {
    if (a.Weight(k) != b.Weight(k)) return false;
  }
  return true;
}

Handle(Geom_Curve) basis_of(const Handle(Geom_Curve) & curve) {
  const auto trimmed = Handle(Geom_TrimmedCurve)::DownCast(curve);
  return trimmed.IsNull() ? curve : trimmed->BasisCurve();
}

// The cubic spline on uniform spans that interpolates `place` at its Greville abscissae.
Handle(Geom_BSplineCurve)
    interpolated(const std::function<Vec3(double)>& place, double first, double last, int spans) {
  constexpr int kDegree = 3;
  std::vector<double> knots(kDegree, first);
  for (int k = 0; k <= spans; ++k) knots.push_back(first + (last - first) * k / spans);
  knots.back() = last;
  knots.insert(knots.end(), kDegree, last);
  const KnotVector basis(kDegree, knots);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Matrix<double, Eigen::Dynamic, 3> right(basis.size(), 3);
  for (int row = 0; row < basis.size(); ++row) {
    const double at =
        std::clamp((knots[static_cast<size_t>(row) + 1] + knots[static_cast<size_t>(row) + 2] +
                    knots[static_cast<size_t>(row) + 3]) /
                       kDegree,
                   first, last);
    const BasisValues values = evaluate_basis(basis, at);
    for (int j = 0; j <= kDegree; ++j) {
      entries.emplace_back(row, values.first + j, values.value(0, j));
    }
    right.row(row) = place(at);
  }
  Eigen::SparseMatrix<double> matrix(basis.size(), basis.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> factors(matrix);
  const Eigen::Matrix<double, Eigen::Dynamic, 3> poles = factors.solve(right);
  TColgp_Array1OfPnt array(1, basis.size());
  for (int k = 0; k < basis.size(); ++k)
    array(k + 1) = gp_Pnt(poles(k, 0), poles(k, 1), poles(k, 2));
  TColStd_Array1OfReal values(1, spans + 1);
  TColStd_Array1OfInteger multiplicities(1, spans + 1);
  for (int k = 0; k <= spans; ++k) {
    values(k + 1) = knots[static_cast<size_t>(kDegree + k)];
    multiplicities(k + 1) = k == 0 || k == spans ? kDegree + 1 : 1;
  }
  return new Geom_BSplineCurve(array, values, multiplicities, kDegree);
}

// With as many spans as the tolerance needs; null when those are too many.
Handle(Geom_BSplineCurve) fitted_curve(const std::function<Vec3(double)>& place, double first,
                                       double last, double tolerance) {
  for (int spans = kFirstSpans; spans <= kMostSpans; spans *= 2) {
    const auto curve = interpolated(place, first, last, spans);
    double deviation = 0.0;
    const int samples = kFitSamples * spans;
    for (int k = 0; k < samples; ++k) {
      const double t = first + (last - first) * (k + 0.5) / samples;
      const gp_Pnt p = curve->Value(t);
      deviation = std::max(deviation, (place(t) - Vec3(p.X(), p.Y(), p.Z())).norm());
    }
    if (deviation <= tolerance) return curve;
  }
  return {};
}

// A copy without weights that can be refined; null when there is none with the same parameter.
Handle(Geom_BSplineCurve) as_spline(const Handle(Geom_Curve) & curve, double first, double last) {
  Handle(Geom_BSplineCurve) spline;
  if (!Handle(Geom_Line)::DownCast(curve).IsNull()) {
    spline = GeomConvert::CurveToBSplineCurve(new Geom_TrimmedCurve(curve, first, last));
  } else if (!Handle(Geom_BSplineCurve)::DownCast(curve).IsNull()) {
    spline = Handle(Geom_BSplineCurve)::DownCast(curve->Copy());
  }
  if (spline.IsNull() || spline->IsRational() || spline->IsPeriodic()) return {};
  return spline;
}

void insert_knots_of(const Geom_BSplineCurve& other, double near, Geom_BSplineCurve& curve) {
  for (int k = 2; k < other.NbKnots(); ++k) {
    curve.InsertKnot(other.Knot(k), other.Multiplicity(k), near, Standard_False);
  }
}

// Both curves on [first, last] in the coarsest basis that holds them; false when there is none.
bool bring_to_common_basis(Geom_BSplineCurve& a, Geom_BSplineCurve& b, double first, double last) {
  if (b.IsRational() || b.IsPeriodic()) return false;
  const double near = kSameParameter * (last - first);
  for (Geom_BSplineCurve* curve : {&a, &b}) {
    if (curve->FirstParameter() > first + near || curve->LastParameter() < last - near) {
      return false;
    }
    const double from = std::max(first, curve->FirstParameter());
    const double to = std::min(last, curve->LastParameter());
    if (from > curve->FirstParameter() || to < curve->LastParameter()) curve->Segment(from, to);
  }
  const int degree = std::max(a.Degree(), b.Degree());
  a.IncreaseDegree(degree);
  b.IncreaseDegree(degree);
  insert_knots_of(b, near, a);
  insert_knots_of(a, near, b);
  if (a.NbPoles() != b.NbPoles() || a.NbKnots() != b.NbKnots()) return false;
  for (int k = 1; k <= a.NbKnots(); ++k) {
    if (a.Multiplicity(k) != b.Multiplicity(k) || std::abs(a.Knot(k) - b.Knot(k)) > near) {
      return false;
    }
  }
  return true;
}

}  // namespace

Displacement::Displacement(const TopoDS_Face& face, const Surface& before, const Surface& after)
    : face_(face), after_(after), difference_(difference_of(before, after)) {
  BRep_Tool::Surface(face, location_);
  noise_ = kNoise * std::max(largest_coordinate(before), largest_coordinate(after));
}

double Displacement::snapped(double value, const KnotVector& knots) const {
  const double near = kSameParameter * (knots.end() - knots.begin());
  if (std::abs(value - knots.begin()) <= near) return knots.begin();
  if (std::abs(value - knots.end()) <= near) return knots.end();
  return value;
}

double Displacement::along(const TopoDS_Edge& edge) const {
  const ParameterCurve curve(edge, face_);
  if (curve.curve.IsNull()) return 0.0;
  int samples = kSamples;
  samples =
      std::max({samples, kSamplesPerSpan * after_.u_size(), kSamplesPerSpan * after_.v_size()});
  double largest = 0.0;
  for (int k = 0; k <= samples; ++k) {
    const Uv uv = curve.at(static_cast<double>(k) / samples);
    const Vec3 d =
        difference_.point(snapped(uv.u, after_.u_knots()), snapped(uv.v, after_.v_knots()));
    if (!is_noise(d)) largest = std::max(largest, d.norm());
  }
  return largest;
}

Vec3 Displacement::at_end(const TopoDS_Edge& edge, int end) const { return at(edge, end); }

double Displacement::gap_to(const TopoDS_Edge& edge, const Geom_Curve& curve) const {
  const ParameterCurve on_face(edge, face_);
  if (on_face.curve.IsNull()) return 0.0;
  double gap = 0.0;
  for (int k = 0; k <= kGapSamples; ++k) {
    const double fraction = static_cast<double>(k) / kGapSamples;
    const Uv uv = on_face.at(fraction);
    const Vec3 p = after_.point(snapped(uv.u, after_.u_knots()), snapped(uv.v, after_.v_knots()));
    const gp_Pnt on_curve = curve.Value(on_face.first + fraction * (on_face.last - on_face.first));
    gap = std::max(gap, on_curve.Distance(gp_Pnt(p.x(), p.y(), p.z())));
  }
  return gap;
}

Vec3 Displacement::at(const TopoDS_Edge& edge, double fraction) const {
  const ParameterCurve curve(edge, face_);
  if (curve.curve.IsNull()) return Vec3::Zero();
  const Uv uv = curve.at(fraction);
  const Vec3 d =
      difference_.point(snapped(uv.u, after_.u_knots()), snapped(uv.v, after_.v_knots()));
  return is_noise(d) ? Vec3(Vec3::Zero()) : d;
}

std::optional<IsoRun> Displacement::iso_run(const TopoDS_Edge& edge) const {
  const ParameterCurve curve(edge, face_);
  if (curve.curve.IsNull() || curve.last == curve.first) return std::nullopt;
  const Uv start = curve.at(0.0), finish = curve.at(1.0);
  const auto &u = after_.u_knots(), &v = after_.v_knots();
  const double near_u = kSameParameter * (u.end() - u.begin());
  const double near_v = kSameParameter * (v.end() - v.begin());
  IsoRun run;
  run.along_v = std::abs(start.u - finish.u) <= near_u;
  const double a = run.along_v ? start.v : start.u, b = run.along_v ? finish.v : finish.u;
  run.constant = run.along_v ? snapped(start.u, u) : snapped(start.v, v);
  run.slope = (b - a) / (curve.last - curve.first);
  // Lines of unit speed are the rule; their slope must not carry a rounding.
  if (std::abs(std::abs(run.slope) - 1.0) <= kSameParameter) run.slope = run.slope > 0 ? 1.0 : -1.0;
  run.offset = a - run.slope * curve.first;
  if (std::abs(run.offset) <= kNoise * (std::abs(a) + std::abs(curve.first))) run.offset = 0.0;
  if (run.slope == 0.0) return std::nullopt;
  for (int k = 0; k <= kSamples; ++k) {
    const double fraction = static_cast<double>(k) / kSamples;
    const Uv uv = curve.at(fraction);
    const double t = curve.first + fraction * (curve.last - curve.first);
    const double off = run.along_v ? std::abs(uv.u - start.u) : std::abs(uv.v - start.v);
    const double uneven = std::abs((run.along_v ? uv.v : uv.u) - (run.slope * t + run.offset));
    if (off > (run.along_v ? near_u : near_v) || uneven > (run.along_v ? near_v : near_u)) {
      return std::nullopt;
    }
  }
  return run;
}

Handle(Geom_Curve) Displacement::new_curve(const TopoDS_Edge& edge, const IsoRun& run) const {
  const auto shift = iso_curve(difference_, run);
  TopLoc_Location location;
  double first = 0.0, last = 0.0;
  const Handle(Geom_Curve) old = basis_of(BRep_Tool::Curve(edge, location, first, last));
  if (!location.IsEqual(location_)) return iso_curve(after_, run);
  auto curve = Handle(Geom_BSplineCurve)::DownCast(old);
  if (curve.IsNull() || !same_basis(*curve, *shift)) {
    curve = as_spline(old, first, last);
    // The edge of two faces in different bases, or of a part of a side: both curves in one basis.
    if (curve.IsNull() || !bring_to_common_basis(*curve, *shift, first, last)) {
      return iso_curve(after_, run);
    }
  } else {
    curve = Handle(Geom_BSplineCurve)::DownCast(curve->Copy());
  }
  for (int k = 1; k <= curve->NbPoles(); ++k) {
    const gp_Pnt d = shift->Pole(k);
    if (is_noise(Vec3(d.X(), d.Y(), d.Z()))) continue;
    curve->SetPole(k, curve->Pole(k).Translated(gp_Vec(d.X(), d.Y(), d.Z())));
  }
  return curve;
}

Handle(Geom_BSplineCurve) displaced_curve(const TopoDS_Edge& edge, const TopLoc_Location& location,
                                          const std::function<Vec3(double)>& by, double tolerance) {
  TopLoc_Location own;
  double first = 0.0, last = 0.0;
  const Handle(Geom_Curve) old = BRep_Tool::Curve(edge, own, first, last);
  if (old.IsNull() || !own.IsEqual(location)) return {};
  const auto fraction = [&](double t) { return (t - first) / (last - first); };
  const auto shift =
      fitted_curve([&](double t) { return by(fraction(t)); }, first, last, tolerance);
  if (shift.IsNull()) return {};
  Handle(Geom_BSplineCurve) curve = as_spline(basis_of(old), first, last);
  if (!curve.IsNull() && bring_to_common_basis(*curve, *shift, first, last)) {
    for (int k = 1; k <= curve->NbPoles(); ++k) {
      curve->SetPole(k, curve->Pole(k).Translated(gp_Vec(shift->Pole(k).XYZ())));
    }
    return curve;
  }
  const auto moved = [&](double t) {
    const gp_Pnt p = old->Value(t);
    return Vec3(Vec3(p.X(), p.Y(), p.Z()) + by(fraction(t)));
  };
  return fitted_curve(moved, first, last, tolerance);
}

}  // namespace isochor::internal
