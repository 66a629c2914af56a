#include "isochor/step/flux.h"

#include <BRepBndLib.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <GeomAbs_Shape.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <math.hxx>
#include <math_Vector.hxx>

#include "isochor/base/tolerance.h"

namespace isochor::internal {
namespace {

// Rules of this many points resolve a sixth of a turn, or a rational span, to rounding; halving
// tests it.
constexpr int kSmoothPoints = 16;
constexpr int kMaxExactPoints = 48;
constexpr int kAreaPoints = 6;       // areas are not polynomial: a few points more than flux needs
constexpr double kWidestTurn = 1.1;  // radians per piece of an angular parameter
constexpr int kMaxHalvings = 8;
constexpr double kConverged = 1e-15;  // relative to the absolute integral of the face
constexpr int kCrossingSamples = 32;

struct Rule {
  std::vector<double> nodes, weights;  // on [0, 1]
};

Rule rule_of(int count) {
  math_Vector x(1, count), w(1, count);
  math::GaussPoints(count, x);
  math::GaussWeights(count, w);
  Rule rule;
  for (int k = 1; k <= count; ++k) {
    rule.nodes.push_back(0.5 * (1.0 + x(k)));
    rule.weights.push_back(0.5 * w(k));
  }
  return rule;
}

// Running sums. `size` and `noise` are integrals of absolute values: what rounding errors of the
// terms and of the derivatives scale with.
struct Sums {
  long double flux = 0.0, projected = 0.0, area = 0.0;
  long double size = 0.0, noise = 0.0, projected_noise = 0.0;

  void add(const Sums& o, double factor) {
    flux += o.flux * factor;
    projected += o.projected * factor;
    area += o.area * factor;
    const double weight = std::abs(factor);
    size += o.size * weight;
    noise += o.noise * weight;
    projected_noise += o.projected_noise * weight;
  }
};

// The surface with what the rules need to know about it.
class Integrand {
 public:
  Integrand(const Handle(Geom_Surface) & surface, double z0);

  bool polynomial() const { return polynomial_; }
  int u_degree() const { return u_degree_; }
  int v_degree() const { return v_degree_; }
  const std::vector<double>& u_breaks() const { return breaks_.u; }
  const std::vector<double>& v_breaks() const { return breaks_.v; }
  void start_at(double u) { start_ = u; }

  // Q and its companions at (u, v). `fine`: with a larger rule, to see what the rule is worth.
  Sums inner(double u, double v, bool fine) const;

 private:
  void add_piece(double from, double to, double v, const Rule& rule, double sign, Sums& sums) const;

  Handle(Geom_Surface) surface_;
  double z0_;
  double start_ = 0.0;
  bool polynomial_ = false;
  bool angular_u_ = false;
  int u_degree_ = 0, v_degree_ = 0;
  double least_u_step_ = 0.0, least_v_step_ = 0.0;
  SurfaceBreaks breaks_;
  Rule rule_, fine_rule_;
};

double least_step(const std::vector<double>& breaks) {
  double least = std::numeric_limits<double>::infinity();
  for (size_t k = 1; k < breaks.size(); ++k) least = std::min(least, breaks[k] - breaks[k - 1]);
  return least;
}

// Breaks of a periodic direction, repeated, because pcurves may run past the period.
void repeat(std::vector<double>& breaks, double period) {
  std::vector<double> all;
  for (int turn = -1; turn <= 1; ++turn) {
    for (size_t k = 0; k + 1 < breaks.size(); ++k) all.push_back(breaks[k] + turn * period);
  }
  all.push_back(breaks.back() + period);
  breaks = std::move(all);
}

Integrand::Integrand(const Handle(Geom_Surface) & surface, double z0)
    : surface_(surface), z0_(z0), breaks_(surface_breaks(surface)) {
  const GeomAdaptor_Surface adaptor(surface);
  switch (adaptor.GetType()) {
    case GeomAbs_Plane:
      polynomial_ = true;
      u_degree_ = v_degree_ = 1;
      break;
    case GeomAbs_BSplineSurface:
    case GeomAbs_BezierSurface:
      u_degree_ = adaptor.UDegree();
      v_degree_ = adaptor.VDegree();
      polynomial_ = !adaptor.IsURational() && !adaptor.IsVRational();
      break;
    case GeomAbs_SurfaceOfExtrusion:
      u_degree_ = v_degree_ = 1;
      break;
    default:
      break;
  }
  angular_u_ = u_degree_ <= 1 && adaptor.IsUPeriodic();
  const int exact = std::min((3 * u_degree_ + 1) / 2, kMaxExactPoints);
  const bool plane = adaptor.GetType() == GeomAbs_Plane;
  const int points = std::max(exact, plane ? 2 : polynomial_ ? kAreaPoints : kSmoothPoints);
  rule_ = rule_of(points);
  fine_rule_ = polynomial_ ? rule_ : rule_of(std::min(points + 9, 61));
  least_u_step_ = least_step(breaks_.u);
  least_v_step_ = least_step(breaks_.v);
  if (surface->IsUPeriodic()) repeat(breaks_.u, surface->UPeriod());
  if (surface->IsVPeriodic()) repeat(breaks_.v, surface->VPeriod());
}

void Integrand::add_piece(double from, double to, double v, const Rule& rule, double sign,
                          Sums& sums) const {
  const double step = to - from;
  gp_Pnt p;
  gp_Vec du, dv;
  for (size_t k = 0; k < rule.nodes.size(); ++k) {
    surface_->D1(from + step * rule.nodes[k], v, p, du, dv);
    const double w = sign * step * rule.weights[k];
    const double height = p.Z() - z0_;
    const double jacobian = du.X() * dv.Y() - dv.X() * du.Y();
    sums.flux += w * height * jacobian;
    sums.projected += w * jacobian;
    sums.area += w * du.Crossed(dv).Magnitude();
    // Positions are good to eps |p|, derivatives to eps |p| per step of the knots.
    const double reach = std::abs(p.X()) + std::abs(p.Y()) + std::abs(p.Z());
    const double slope_u = du.Magnitude() + u_degree_ * reach / least_u_step_;
    const double slope_v = dv.Magnitude() + v_degree_ * reach / least_v_step_;
    const double mixed = std::abs(w) * (slope_u * dv.Magnitude() + slope_v * du.Magnitude());
    sums.size += std::abs(w * height * jacobian);
    sums.noise += std::abs(height) * mixed + reach * std::abs(w * jacobian);
    sums.projected_noise += mixed;
  }
}

Sums Integrand::inner(double u, double v, bool fine) const {
  const double low = std::min(start_, u);
  const double high = std::max(start_, u);
  const double sign = u >= start_ ? 1.0 : -1.0;
  const Rule& rule = fine ? fine_rule_ : rule_;
  Sums sums;
  double from = low;
  const auto piece = [&](double to) {
    const int parts =
        angular_u_ ? std::max(1, static_cast<int>(std::ceil((to - from) / kWidestTurn))) : 1;
    const double step = (to - from) / parts;
    for (int k = 0; k < parts; ++k) {
      add_piece(from + k * step, k + 1 == parts ? to : from + (k + 1) * step, v, rule, sign, sums);
    }
    from = to;
  };
  for (double at : breaks_.u) {
    if (at > from && at < high) piece(at);
  }
  if (high > from) piece(high);
  return sums;
}

// A piece of a loop: u(t), v(t) and v'(t), or a straight line.
class Path {
 public:
  Path(const EdgeUse& use) : use_(&use) {}
  Path(const gp_Pnt2d& a, const gp_Pnt2d& b) : a_(a), b_(b) {}

  double first() const { return use_ ? use_->first : 0.0; }
  double last() const { return use_ ? use_->last : 1.0; }
  double sign() const { return use_ && use_->reversed ? -1.0 : 1.0; }
  void at(double t, gp_Pnt2d& p, gp_Vec2d& d) const {
    if (use_) {
      use_->curve->D1(t, p, d);
    } else {
      d = gp_Vec2d(a_, b_);
      p = a_.Translated(d * t);
    }
  }
  gp_Pnt2d value(double t) const {
    gp_Pnt2d p;
    gp_Vec2d d;
    at(t, p, d);
    return p;
  }
  // 0: not a polynomial.
  int degree() const;
  std::vector<double> breaks() const;

 private:
  const EdgeUse* use_ = nullptr;
  gp_Pnt2d a_, b_;
};

int Path::degree() const {
  if (!use_) return 1;
  const Geom2dAdaptor_Curve curve(use_->curve);
  switch (curve.GetType()) {
    case GeomAbs_Line:
      return 1;
    case GeomAbs_BSplineCurve:
    case GeomAbs_BezierCurve:
      return curve.IsRational() ? 0 : curve.Degree();
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

// Adds the parameters where a coordinate of the path passes `levels`, between samples t0 and t1.
void add_crossings(const Path& path, double t0, double t1, const std::vector<double>& levels,
                   bool u, std::vector<double>& out) {
  const auto coordinate = [&](double t) { return u ? path.value(t).X() : path.value(t).Y(); };
  const double c0 = coordinate(t0);
  const double c1 = coordinate(t1);
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

// Adds Q dv along paths.
class Contour {
 public:
  Contour(Integrand& integrand) : integrand_(&integrand) {}

  void add(const Path& path);
  const Sums& sums() const { return sums_; }
  double error() const { return error_; }
  double projected_error() const { return projected_error_; }

 private:
  // One Gauss rule on [t0, t1].
  Sums rule_sum(const Path& path, double t0, double t1, const Rule& rule, bool fine) const;
  void add_piece(const Path& path, double t0, double t1, int exact_points);
  void halve(const Path& path, double t0, double t1, const Sums& coarse, int depth);

  Integrand* integrand_;
  Rule smooth_rule_ = rule_of(kSmoothPoints);
  Sums sums_;
  double error_ = 0.0, projected_error_ = 0.0;
};

Sums Contour::rule_sum(const Path& path, double t0, double t1, const Rule& rule, bool fine) const {
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

void Contour::halve(const Path& path, double t0, double t1, const Sums& coarse, int depth) {
  const double middle = 0.5 * (t0 + t1);
  const Sums left = rule_sum(path, t0, middle, smooth_rule_, true);
  const Sums right = rule_sum(path, middle, t1, smooth_rule_, true);
  Sums both = left;
  both.add(right, 1.0);
  const double change = std::abs(static_cast<double>(both.flux - coarse.flux));
  const double scale = static_cast<double>(sums_.size + both.size);
  if (change <= kConverged * scale || depth == kMaxHalvings) {
    sums_.add(both, 1.0);
    error_ += change;
    projected_error_ += std::abs(static_cast<double>(both.projected - coarse.projected));
    return;
  }
  halve(path, t0, middle, left, depth + 1);
  halve(path, middle, t1, right, depth + 1);
}

void Contour::add_piece(const Path& path, double t0, double t1, int exact_points) {
  if (exact_points > 0) {
    sums_.add(rule_sum(path, t0, t1, rule_of(exact_points), false), 1.0);
    return;
  }
  halve(path, t0, t1, rule_sum(path, t0, t1, smooth_rule_, false), 0);
}

void Contour::add(const Path& path) {
  const std::vector<double> smooth = path.breaks();
  std::vector<double> cuts = smooth;
  double change_u = 0.0;
  double change_v = 0.0;
  const gp_Pnt2d origin = path.value(path.first());
  for (size_t p = 0; p + 1 < smooth.size(); ++p) {
    const int samples = path.degree() == 1 ? 1 : kCrossingSamples;
    for (int k = 0; k < samples; ++k) {
      const double t0 = smooth[p] + (smooth[p + 1] - smooth[p]) * k / samples;
      const double t1 = smooth[p] + (smooth[p + 1] - smooth[p]) * (k + 1) / samples;
      const gp_Pnt2d end = path.value(t1);
      change_u = std::max(change_u, std::abs(end.X() - origin.X()));
      change_v = std::max(change_v, std::abs(end.Y() - origin.Y()));
      add_crossings(path, t0, t1, integrand_->u_breaks(), true, cuts);
      add_crossings(path, t0, t1, integrand_->v_breaks(), false, cuts);
    }
  }
  if (change_v == 0.0) return;
  std::sort(cuts.begin(), cuts.end());
  int exact = 0;
  if (integrand_->polynomial() && path.degree() > 0) {
    const int across = change_u == 0.0 ? 0 : 3 * integrand_->u_degree();
    const int degree = path.degree() * (across + 3 * integrand_->v_degree()) - 1;
    exact = degree / 2 + 1 <= kMaxExactPoints ? std::max(degree / 2 + 1, kAreaPoints) : 0;
  }
  for (size_t k = 0; k + 1 < cuts.size(); ++k) {
    if (cuts[k + 1] > cuts[k]) add_piece(path, cuts[k], cuts[k + 1], exact);
  }
}

// The loops of a face that uses its whole surface: the sides, of which only u = const count.
bool add_domain(const Handle(Geom_Surface) & surface, Integrand& integrand, Contour& contour) {
  double u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  for (double at : {u0, u1, v0, v1}) {
    if (Precision::IsInfinite(at)) return false;
  }
  integrand.start_at(u0);
  contour.add(Path(gp_Pnt2d(u1, v0), gp_Pnt2d(u1, v1)));
  return true;
}

// Files leave gaps between the curves of a loop; a straight step closes each. False when a step is
// so long that it is no gap but a missing edge.
bool add_steps(const Handle(Geom_Surface) & surface, const FaceLoop& loop, Contour& contour) {
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

bool add_loops(const Handle(Geom_Surface) & surface, const std::vector<FaceLoop>& loops,
               Integrand& integrand, Contour& contour) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const FaceLoop& loop : loops) {
    for (const EdgeUse& use : loop.uses) {
      if (use.curve.IsNull()) return false;
      low = std::min({low, use.start().X(), use.finish().X()});
      high = std::max({high, use.start().X(), use.finish().X()});
    }
  }
  integrand.start_at(0.5 * (low + high));
  bool closed = true;
  for (const FaceLoop& loop : loops) {
    for (const EdgeUse& use : loop.uses) contour.add(Path(use));
    closed = loop.ordered && add_steps(surface, loop, contour) && closed;
  }
  return closed;
}

}  // namespace

double FaceIntegrals::bound_about_zero(double z0) const {
  return bound + std::abs(z0) * projected_bound;
}

FaceIntegrals integrate_face(const Handle(Geom_Surface) & surface,
                             const std::vector<FaceLoop>& loops, TrimKind kind, bool reversed,
                             double z0) {
  Integrand integrand(surface, z0);
  Contour contour(integrand);
  const bool closed = kind == TrimKind::kNatural ? add_domain(surface, integrand, contour)
                                                 : add_loops(surface, loops, integrand, contour);
  const Sums& sums = contour.sums();
  const double sign = reversed ? -1.0 : 1.0;
  FaceIntegrals result;
  result.flux = sign * static_cast<double>(sums.flux);
  result.projected = sign * static_cast<double>(sums.projected);
  result.area = static_cast<double>(sums.area);
  const double unknown = closed ? 0.0 : std::numeric_limits<double>::infinity();
  result.bound = contour.error() + 4.0 * kUnitRoundoff * static_cast<double>(sums.noise) + unknown;
  result.projected_bound = contour.projected_error() +
                           4.0 * kUnitRoundoff * static_cast<double>(sums.projected_noise) +
                           unknown;
  return result;
}

FaceIntegrals integrate_face(const TopoDS_Face& face, double z0, double distance) {
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  const std::vector<FaceLoop> loops = face_loops(face);
  const TrimKind kind = classify_sides(surface, loops, distance).kind;
  return integrate_face(surface, loops, kind, face.Orientation() == TopAbs_REVERSED, z0);
}

ShapeIntegrals integrate_shape(const TopoDS_Shape& shape) {
  ShapeIntegrals result;
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  double diagonal = 0.0;
  if (!box.IsVoid()) {
    result.z0 = 0.5 * (box.CornerMin().Z() + box.CornerMax().Z());
    diagonal = box.CornerMin().Distance(box.CornerMax());
  }
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    result.faces.push_back(
        integrate_face(TopoDS::Face(it.Current()), result.z0, kSideDistance * diagonal));
    result.volume += result.faces.back().flux;
    result.bound += result.faces.back().bound;
    result.area += result.faces.back().area;
  }
  return result;
}

}  // namespace isochor::internal
