#include "isochor/step/section_integrand.h"

#include <GeomAdaptor_Surface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <algorithm>
#include <cmath>

#include "isochor/bspline/basis.h"
#include "isochor/step/flux_integrand.h"
#include "isochor/step/line_pieces.h"
#include "isochor/step/occt_surface.h"

namespace isochor::internal {
namespace {

constexpr int kSamples = 12;  // of Z on a piece of a line: roots are searched between them
constexpr int kBisections = 54;
constexpr int kSmoothPoints = 16;  // resolve a sixth of a turn, or a quotient

struct LinePoint {
  Vec3 s, su, sv;
};

const UnitRule& rule_of(int points) {
  static const auto rules = [] {
    std::vector<UnitRule> made(1);
    for (int n = 1; n <= 48; ++n) made.push_back(unit_rule(n));
    return made;
  }();
  return rules[static_cast<size_t>(std::min(points, 48))];
}

}  // namespace

void SectionSums::add(const SectionSums& other, double factor) {
  for (size_t k = 0; k < value.size(); ++k) value[k] += other.value[k] * factor;
  size += other.size * std::abs(factor);
  noise += other.noise * std::abs(factor);
  lever = std::max(lever, other.lever);
}

double SectionSums::distance(const SectionSums& other) const {
  double farthest = std::abs(static_cast<double>(value[0] - other.value[0]));
  // One lane may agree by chance.
  for (size_t k = 1; lever > 0.0 && k < value.size(); ++k) {
    farthest = std::max(farthest, std::abs(static_cast<double>(value[k] - other.value[k])) / lever);
  }
  return farthest;
}

void SectionSums::add_distances(const SectionSums& a, const SectionSums& b) {
  for (size_t k = 0; k < value.size(); ++k) value[k] += std::abs(a.value[k] - b.value[k]);
}

// The surface along v = const: contracted once when it is a B-spline.
class SectionIntegrand::Line {
 public:
  Line(const SectionIntegrand& of, double v) : of_(of), v_(v) {
    if (!of.spline_) return;
    const Surface& surface = *of.spline_;
    const BasisValues b = evaluate_basis(surface.v_knots(), v, 1);
    const int count = surface.u_knots().size();
    for (int i = 0; i < count; ++i) {
      Eigen::Vector4d at = Eigen::Vector4d::Zero(), slope = Eigen::Vector4d::Zero();
      for (int j = 0; j <= b.degree; ++j) {
        const size_t k = surface.index(i, b.first + j);
        const double w = surface.rational() ? surface.weights()[k] : 1.0;
        Eigen::Vector4d pole;
        pole << w * surface.poles()[k], w;
        at += b.value(0, j) * pole;
        slope += b.value(1, j) * pole;
      }
      value_.push_back(at);
      slope_.push_back(slope);
    }
  }

  // All coefficients near (from, to) are on one side: -1 below, 1 above, 0 not decided.
  int side(double from, double to) const {
    if (!of_.spline_) return 0;
    const KnotVector& knots = of_.spline_->u_knots();
    const int first = knots.span_of(from) - knots.degree(), last = knots.span_of(to);
    bool above = true, below = true;
    for (int i = first; i <= last; ++i) {
      const Eigen::Vector4d& pole = value_[static_cast<size_t>(i)];
      above = above && pole[2] >= -of_.noise_ * pole[3];
      below = below && pole[2] <= -of_.noise_ * pole[3];
    }
    return above ? 1 : below ? -1 : 0;
  }

  double height(double u) const {
    if (!of_.spline_) return of_.level(gp_Pnt2d(u, v_));
    const BasisValues b = evaluate_basis(of_.spline_->u_knots(), u, 0);
    double z = 0.0, w = 0.0;
    for (int j = 0; j <= b.degree; ++j) {
      z += b.value(0, j) * value_[static_cast<size_t>(b.first + j)][2];
      w += b.value(0, j) * value_[static_cast<size_t>(b.first + j)][3];
    }
    return z / w + of_.noise_;
  }

  LinePoint point(double u) const {
    if (!of_.spline_) {
      gp_Pnt p;
      gp_Vec du, dv;
      of_.surface_->D1(u, v_, p, du, dv);
      return {Vec3(p.X(), p.Y(), p.Z()), Vec3(du.X(), du.Y(), du.Z()),
              Vec3(dv.X(), dv.Y(), dv.Z())};
    }
    const BasisValues b = evaluate_basis(of_.spline_->u_knots(), u, 1);
    Eigen::Vector4d s = Eigen::Vector4d::Zero(), su = s, sv = s;
    for (int j = 0; j <= b.degree; ++j) {
      const auto i = static_cast<size_t>(b.first + j);
      s += b.value(0, j) * value_[i];
      su += b.value(1, j) * value_[i];
      sv += b.value(0, j) * slope_[i];
    }
    const Vec3 at = s.head<3>() / s[3];
    return {at, (su.head<3>() - su[3] * at) / s[3], (sv.head<3>() - sv[3] * at) / s[3]};
  }

 private:
  const SectionIntegrand& of_;
  double v_;
  std::vector<Eigen::Vector4d, Eigen::aligned_allocator<Eigen::Vector4d>> value_, slope_;
};

SectionIntegrand::SectionIntegrand(const Handle(Geom_Surface) & surface, double noise,
                                   const std::optional<FrameField>& field)
    : surface_(surface), noise_(noise), field_(field), breaks_(surface_breaks(surface)) {
  const GeomAdaptor_Surface adaptor(surface);
  bool polynomial = adaptor.GetType() == GeomAbs_Plane;
  u_degree_ = v_degree_ = 1;
  if (adaptor.GetType() == GeomAbs_BSplineSurface || adaptor.GetType() == GeomAbs_BezierSurface) {
    u_degree_ = adaptor.UDegree();
    v_degree_ = adaptor.VDegree();
    polynomial = !adaptor.IsURational() && !adaptor.IsVRational();
  }
  const int exact = field_ ? 2 * u_degree_ : (3 * u_degree_ + 1) / 2;
  points_ = polynomial ? exact : std::max(exact, kSmoothPoints);
  angular_u_ = u_degree_ <= 1 && adaptor.IsUPeriodic();
  if (surface->IsUPeriodic()) repeat_breaks(breaks_.u, surface->UPeriod());
  if (surface->IsVPeriodic()) repeat_breaks(breaks_.v, surface->VPeriod());
  const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface);
  if (!spline.IsNull() && !spline->IsUPeriodic() && !spline->IsVPeriodic()) {
    spline_ = from_occt(*spline);
  }
}

double SectionIntegrand::level(const gp_Pnt2d& at) const {
  return surface_->Value(at.X(), at.Y()).Z() + noise_;
}

bool SectionIntegrand::coplanar() const {
  const GeomAdaptor_Surface adaptor(surface_);
  if (adaptor.GetType() == GeomAbs_Plane) {
    const gp_Pln plane = adaptor.Plane();
    const double tilt = std::hypot(plane.Axis().Direction().X(), plane.Axis().Direction().Y());
    return std::abs(plane.Location().Z()) <= noise_ && tilt <= 1e-14;
  }
  if (!spline_) return false;
  const auto& poles = spline_->poles();
  return std::all_of(poles.begin(), poles.end(),
                     [&](const Vec3& p) { return std::abs(p.z()) <= noise_; });
}

bool SectionIntegrand::above() const {
  if (!spline_) return false;
  const auto& poles = spline_->poles();
  return std::all_of(poles.begin(), poles.end(), [&](const Vec3& p) { return p.z() >= -noise_; });
}

void SectionIntegrand::prepare(double low, double high, double v_low, double v_high) {
  prepare_at(0.5 * (low + high), high, v_low, v_high);
}

void SectionIntegrand::prepare_at(double start, double, double, double) { start_ = start; }

// Where a continuous function changes sign between a and b, at which it has different signs.
template <typename Function>
double sign_change(const Function& f, double a, double b) {
  const bool begin = f(a) < 0.0;
  for (int step = 0; step < kBisections && a < b; ++step) {
    const double middle = 0.5 * (a + b);
    ((f(middle) < 0.0) == begin ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

// The roots of Z on a piece, in order. Between two samples with Z of one sign there may be two:
// then Z has an extremum of the other sign between them.
template <typename Line>
std::vector<double> roots_of(const Line& line, double from, double to) {
  const auto height = [&](double u) { return line.height(u); };
  const auto slope = [&](double u) { return line.point(u).su.z(); };
  std::vector<double> roots;
  double a = from;
  for (int k = 1; k <= kSamples; ++k) {
    const double b = k == kSamples ? to : from + (to - from) * k / kSamples;
    const bool below = height(a) < 0.0;
    if (below != (height(b) < 0.0)) {
      roots.push_back(sign_change(height, a, b));
    } else if ((slope(a) < 0.0) != below && (slope(b) < 0.0) == below) {
      const double extremum = sign_change(slope, a, b);
      if ((height(extremum) < 0.0) != below) {
        roots.push_back(sign_change(height, a, extremum));
        roots.push_back(sign_change(height, extremum, b));
      }
    }
    a = b;
  }
  return roots;
}

// The field's lanes at a point. Heights are as noisy as the distance from the frame's origin is
// long.
void add_lanes(const FrameField& field, const Vec3& at, const Vec3& along_u, const Vec3& along_v,
               double step, double sign, SectionSums& sums) {
  const BelowLanes lanes = lanes_at(field, at, along_u.cross(along_v));
  for (size_t k = 0; k < lanes.size(); ++k) sums.value[k] += sign * step * lanes[k];
  sums.size += step * std::abs(lanes[0]);
  sums.lever = field.lever;
  const double reach = field.slope.norm() * at.norm();
  sums.noise += step * field.direction.norm() * (std::abs(field.at(at)) + reach) * along_u.norm() *
                along_v.norm();
}

// The parts of a smooth piece that lie below, each by one rule.
void SectionIntegrand::add_piece(const Line& line, double from, double to, double sign,
                                 SectionSums& sums) const {
  const int side = line.side(from, to);
  if (side > 0) return;
  std::vector<double> cuts = {from};
  if (side == 0) {
    for (double root : roots_of(line, from, to)) cuts.push_back(root);
  }
  cuts.push_back(to);
  const UnitRule& rule = rule_of(points_);
  for (size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double length = cuts[k + 1] - cuts[k];
    if (!(length > 0.0)) continue;
    if (side == 0 && !(line.height(cuts[k] + 0.5 * length) < 0.0)) continue;
    for (size_t g = 0; g < rule.nodes.size(); ++g) {
      const LinePoint p = line.point(cuts[k] + length * rule.nodes[g]);
      const double step = length * rule.weights[g];
      if (field_) {
        add_lanes(*field_, p.s, p.su, p.sv, step, sign, sums);
        continue;
      }
      const double j = p.su.x() * p.sv.y() - p.sv.x() * p.su.y();
      const double weight = sign * step * j;
      sums.value[0] += weight;
      sums.value[1] += weight * p.s.x();
      sums.value[2] += weight * p.s.y();
      sums.size += std::abs(weight);
      sums.noise += step * p.su.norm() * p.sv.norm();
    }
  }
}

SectionSums SectionIntegrand::inner(double u, double v, bool) const {
  SectionSums sums;
  const double low = std::min(start_, u), high = std::max(start_, u);
  if (!(low < high)) return sums;
  const double sign = u >= start_ ? 1.0 : -1.0;
  const Line line(*this, v);
  for_each_smooth_piece(breaks_.u, low, high, angular_u_,
                        [&](double begin, double end) { add_piece(line, begin, end, sign, sums); });
  return sums;
}

}  // namespace isochor::internal
