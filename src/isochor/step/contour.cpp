#include "isochor/step/contour.h"

#include <Geom2dAdaptor_Curve.hxx>
#include <GeomAbs_Shape.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "isochor/base/tolerance.h"

namespace isochor::internal {
namespace {

constexpr int kCurvePoints = 10;  // per piece of a curve; halving tests it
constexpr int kExactPoints = 48;  // exact rules up to this size
// A piece is good when halving it changes less than Integrand::kConverged, relative to the absolute
// integral of the face. Where that is small (walls along z), rounding errors are the limit.
constexpr int kCrossingSamples = 32;
constexpr int kPlaneSamples = 4;

// A piece of a loop: u(t), v(t) and v'(t), or a straight line.
class Path {
 public:
  explicit Path(const EdgeUse& use)
      : use_(&use), curve_(std::make_shared<Geom2dAdaptor_Curve>(use.curve)) {}
  Path(const gp_Pnt2d& a, const gp_Pnt2d& b) : a_(a), b_(b) {}

  double first() const { return use_ ? use_->first : 0.0; }
  double last() const { return use_ ? use_->last : 1.0; }
  double sign() const { return use_ && use_->reversed ? -1.0 : 1.0; }
  void at(double t, gp_Pnt2d& p, gp_Vec2d& d) const {
    if (use_) {
      curve_->D1(t, p, d);
    } else {
      d = gp_Vec2d(a_, b_);
      p = a_.Translated(d * t);
    }
  }
  gp_Pnt2d value(double t) const {
    return use_ ? curve_->Value(t) : a_.Translated(gp_Vec2d(a_, b_) * t);
  }
  // 0: not a polynomial.
  int degree() const;
  std::vector<double> breaks() const;

 private:
  const EdgeUse* use_ = nullptr;
  std::shared_ptr<Geom2dAdaptor_Curve> curve_;  // keeps the span it was last asked for
  gp_Pnt2d a_, b_;
};

int Path::degree() const {
  if (!use_) return 1;
  switch (curve_->GetType()) {
    case GeomAbs_Line:
      return 1;
    case GeomAbs_BSplineCurve:
    case GeomAbs_BezierCurve:
      return curve_->IsRational() ? 0 : curve_->Degree();
    default:
      return 0;
  }
}

std::vector<double> Path::breaks() const {
  if (!use_) return {0.0, 1.0};
  const Geom2dAdaptor_Curve curve(use_->curve, use_->first, use_->last);
  TColStd_Array1OfReal at(1, curve.NbIntervals(GeomAbs_CN) + 1);
  curve.Intervals(at, GeomAbs_CN);
  return {at.begin(), at.end()};
}

// Adds the parameters where `coordinate` passes one of the levels between t0 and t1, where it is c0
// and c1.
template <typename Coordinate>
void add_crossings(const Coordinate& coordinate, double t0, double t1, double c0, double c1,
                   const std::vector<double>& levels, std::vector<double>& out) {
  const double low = std::min(c0, c1);
  const double high = std::max(c0, c1);
  auto level = std::upper_bound(levels.begin(), levels.end(), low);
  for (; level != levels.end() && *level < high; ++level) {
    double a = t0;
    double b = t1;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (a + b);
      if ((coordinate(middle) < *level) == (c0 < *level)) {
        a = middle;
      } else {
        b = middle;
      }
    }
    out.push_back(0.5 * (a + b));
  }
}

// Adds Q dv along paths: first all of them by coarse rules, which tells what counts as small, then
// better where halving changes something.
template <typename Integrand>
class Contour {
 public:
  using Sums = typename Integrand::Sums;
  explicit Contour(const Integrand& integrand) : integrand_(&integrand) {}

  void add(const Path& path);
  void finish();
  const Sums& sums() const { return sums_; }
  const Sums& errors() const { return errors_; }

 private:
  struct Piece {
    Path path;
    double t0, t1;
    Sums coarse;
    bool exact;
  };

  // One Gauss rule on [t0, t1].
  Sums rule_sum(const Path& path, double t0, double t1, const UnitRule& rule, bool fine) const;
  std::vector<double> cuts(const Path& path, bool& u_varies, bool& v_varies) const;
  void halve(const Path& path, double t0, double t1, const Sums& coarse, int depth);

  const Integrand* integrand_;
  int halvings_ = 0;
  UnitRule curve_rule_ = unit_rule(kCurvePoints);
  std::vector<Piece> pieces_;
  double negligible_ = 0.0;
  Sums sums_;
  Sums errors_;  // what halving the last pieces changed
};

template <typename Integrand>
typename Integrand::Sums Contour<Integrand>::rule_sum(const Path& path, double t0, double t1,
                                                      const UnitRule& rule, bool fine) const {
  Sums sums;
  gp_Pnt2d p;
  gp_Vec2d d;
  for (size_t k = 0; k < rule.nodes.size(); ++k) {
    path.at(t0 + (t1 - t0) * rule.nodes[k], p, d);
    const double factor = (t1 - t0) * rule.weights[k] * d.Y() * path.sign();
    if (factor != 0.0) sums.add(integrand_->inner(p.X(), p.Y(), fine), factor);
  }
  return sums;
}

template <typename Integrand>
void Contour<Integrand>::halve(const Path& path, double t0, double t1, const Sums& coarse,
                               int depth) {
  const double middle = 0.5 * (t0 + t1);
  const Sums left = rule_sum(path, t0, middle, curve_rule_, true);
  const Sums right = rule_sum(path, middle, t1, curve_rule_, true);
  Sums both = left;
  both.add(right, 1.0);
  if (both.distance(coarse) <= negligible_ || depth == Integrand::kMaxHalvings ||
      ++halvings_ > Integrand::kHalvings) {
    sums_.add(both, 1.0);
    errors_.add_distances(both, coarse);
    return;
  }
  halve(path, t0, middle, left, depth + 1);
  halve(path, middle, t1, right, depth + 1);
}

template <typename Integrand>
std::vector<double> Contour<Integrand>::cuts(const Path& path, bool& u_varies,
                                             bool& v_varies) const {
  const std::vector<double> smooth = path.breaks();
  std::vector<double> at = smooth;
  const gp_Pnt2d origin = path.value(path.first());
  const auto u = [&](double t) { return path.value(t).X(); };
  const auto v = [&](double t) { return path.value(t).Y(); };
  const auto level = [&](double t) {
    if constexpr (Integrand::kHasLevel) return integrand_->level(path.value(t));
    return 0.0;
  };
  int samples = path.degree() == 1 && !Integrand::kHasLevel ? 1 : kCrossingSamples;
  // Nothing to cross: only whether the coordinates vary is asked.
  if (!Integrand::kHasLevel && integrand_->plane()) {
    samples = std::min(samples, std::max(kPlaneSamples, path.degree() + 2));
  }
  for (size_t p = 0; p + 1 < smooth.size(); ++p) {
    double t0 = smooth[p];
    gp_Pnt2d begin = path.value(t0);
    double level0 = level(t0);
    for (int k = 0; k < samples; ++k) {
      const double t1 = smooth[p] + (smooth[p + 1] - smooth[p]) * (k + 1) / samples;
      const gp_Pnt2d end = path.value(t1);
      const double level1 = level(t1);
      u_varies = u_varies || end.X() != origin.X();
      v_varies = v_varies || end.Y() != origin.Y();
      add_crossings(u, t0, t1, begin.X(), end.X(), integrand_->u_breaks(), at);
      add_crossings(v, t0, t1, begin.Y(), end.Y(), integrand_->v_breaks(), at);
      if (Integrand::kHasLevel) add_crossings(level, t0, t1, level0, level1, {0.0}, at);
      t0 = t1;
      begin = end;
      level0 = level1;
    }
  }
  std::sort(at.begin(), at.end());
  return at;
}

template <typename Integrand>
void Contour<Integrand>::add(const Path& path) {
  bool u_varies = false;
  bool v_varies = false;
  const std::vector<double> at = cuts(path, u_varies, v_varies);
  if (!v_varies) return;
  int points = 0;
  if (integrand_->polynomial() && path.degree() > 0) {
    const int across = u_varies ? Integrand::kFactors * integrand_->u_degree() : 0;
    points = (path.degree() * (across + Integrand::kFactors * integrand_->v_degree()) - 1) / 2 + 1;
    if (!integrand_->plane()) points = std::max(points, Integrand::kLeastPoints);
  }
  const bool exact = points > 0 && points <= kExactPoints;
  const UnitRule rule = exact ? unit_rule(points) : curve_rule_;
  for (size_t k = 0; k + 1 < at.size(); ++k) {
    if (!(at[k + 1] > at[k])) continue;
    pieces_.push_back(
        {path, at[k], at[k + 1], rule_sum(path, at[k], at[k + 1], rule, false), exact});
  }
}

template <typename Integrand>
void Contour<Integrand>::finish() {
  for (const Piece& piece : pieces_) {
    negligible_ += Integrand::kConverged * static_cast<double>(piece.coarse.size) +
                   kUnitRoundoff * piece.coarse.largest_noise();
  }
  for (const Piece& piece : pieces_) {
    if (piece.exact) {
      sums_.add(piece.coarse, 1.0);
    } else {
      halve(piece.path, piece.t0, piece.t1, piece.coarse, 0);
    }
  }
}

// The loops of a face that uses its whole surface: the sides, of which only u = const count.
template <typename Integrand>
bool add_domain(const Handle(Geom_Surface) & surface, Integrand& integrand,
                Contour<Integrand>& contour) {
  double u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  for (double at : {u0, u1, v0, v1}) {
    if (Precision::IsInfinite(at)) return false;
  }
  integrand.prepare_at(u0, u1, v0, v1);
  contour.add(Path(gp_Pnt2d(u1, v0), gp_Pnt2d(u1, v1)));
  return true;
}

// Files leave gaps between the curves of a loop; a straight step closes each. False when a step is
// so long that it is no gap but a missing edge.
template <typename Integrand>
bool add_steps(const Handle(Geom_Surface) & surface, const FaceLoop& loop,
               Contour<Integrand>& contour) {
  for (size_t k = 0; k < loop.uses.size(); ++k) {
    const EdgeUse& use = loop.uses[k];
    const EdgeUse& next = loop.uses[(k + 1) % loop.uses.size()];
    const gp_Pnt2d from = use.finish();
    const gp_Pnt2d to = next.start();
    if (from.X() == to.X() && from.Y() == to.Y()) continue;
    const double gap = surface->Value(from.X(), from.Y()).Distance(surface->Value(to.X(), to.Y()));
    // Twice for two curves of one vertex, and as much again because few files keep the promise.
    if (gap > 8.0 * std::max({use.tolerance, next.tolerance, Precision::Confusion()})) return false;
    contour.add(Path(from, to));
  }
  return true;
}

// The box of the loops' ends; false when a curve is missing.
bool loop_box(const std::vector<FaceLoop>& loops, UvBox& box) {
  const double huge = std::numeric_limits<double>::infinity();
  box = {huge, -huge, huge, -huge};
  for (const FaceLoop& loop : loops) {
    for (const EdgeUse& use : loop.uses) {
      if (use.curve.IsNull()) return false;
      for (double t : {use.first, 0.5 * (use.first + use.last), use.last}) {
        const gp_Pnt2d p = use.curve->Value(t);
        box.u_min = std::min(box.u_min, p.X());
        box.u_max = std::max(box.u_max, p.X());
        box.v_min = std::min(box.v_min, p.Y());
        box.v_max = std::max(box.v_max, p.Y());
      }
    }
  }
  return true;
}

template <typename Integrand>
bool add_loops(const Handle(Geom_Surface) & surface, const std::vector<FaceLoop>& loops,
               Integrand& integrand, Contour<Integrand>& contour) {
  UvBox box;
  if (!loop_box(loops, box)) return false;
  integrand.prepare(box.u_min, box.u_max, box.v_min, box.v_max);
  bool closed = true;
  for (const FaceLoop& loop : loops) {
    for (const EdgeUse& use : loop.uses) contour.add(Path(use));
    closed = loop.ordered && add_steps(surface, loop, contour) && closed;
  }
  return closed;
}

// Sums, errors, and whether the loops close.
template <typename Result, typename Integrand>
Result integrate(const Handle(Geom_Surface) & surface, const std::vector<FaceLoop>& loops,
                 TrimKind trim, Integrand& integrand) {
  Contour<Integrand> contour(integrand);
  const bool closed = trim == TrimKind::kNatural ? add_domain(surface, integrand, contour)
                                                 : add_loops(surface, loops, integrand, contour);
  contour.finish();
  return {contour.sums(), contour.errors(), closed};
}

}  // namespace

template <typename Kind>
RegionIntegrals<Kind> integrate_region(const Handle(Geom_Surface) & surface,
                                       const std::vector<FaceLoop>& loops, TrimKind trim,
                                       const Kind& kind) {
  FluxIntegrand<Kind> integrand(surface, kind);
  return integrate<RegionIntegrals<Kind>>(surface, loops, trim, integrand);
}

RegionIntegrals<SectionIntegrand> integrate_region(const Handle(Geom_Surface) & surface,
                                                   const std::vector<FaceLoop>& loops,
                                                   TrimKind trim, SectionIntegrand& integrand) {
  return integrate<RegionIntegrals<SectionIntegrand>>(surface, loops, trim, integrand);
}

template RegionIntegrals<FluxKind> integrate_region(const Handle(Geom_Surface) &,
                                                    const std::vector<FaceLoop>&, TrimKind,
                                                    const FluxKind&);
template RegionIntegrals<MomentKind> integrate_region(const Handle(Geom_Surface) &,
                                                      const std::vector<FaceLoop>&, TrimKind,
                                                      const MomentKind&);

}  // namespace isochor::internal
