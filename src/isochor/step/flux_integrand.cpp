#include "isochor/step/flux_integrand.h"

#include <GeomAdaptor_Surface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <math.hxx>
#include <math_Vector.hxx>

#include "isochor/base/error.h"
#include "isochor/bspline/basis.h"
#include "isochor/step/line_pieces.h"
#include "isochor/step/occt_surface.h"

namespace isochor::internal {
namespace {

// Rules of this many points resolve a sixth of a turn, or a rational span, to rounding.
constexpr int kSmoothPoints = 16;
constexpr int kFinePoints = 25;
constexpr int kMaxPoints = 48;
constexpr double kRuleTest = 1e-15;  // a rule is good when twice as many points change less

double least_step(const std::vector<double>& breaks) {
  double least = std::numeric_limits<double>::infinity();
  for (size_t k = 1; k < breaks.size(); ++k) least = std::min(least, breaks[k] - breaks[k - 1]);
  return least;
}

}  // namespace

UnitRule unit_rule(int count) {
  math_Vector x(1, count), w(1, count);
  math::GaussPoints(count, x);
  math::GaussWeights(count, w);
  UnitRule rule;
  for (int k = 1; k <= count; ++k) {
    rule.nodes.push_back(0.5 * (1.0 + x(k)));
    rule.weights.push_back(0.5 * w(k));
  }
  return rule;
}

// Columns over i: the surface and its v derivative, contracted with B_j(v) and B_j'(v).
template <typename Kind>
struct FluxIntegrand<Kind>::Line {
  int low = 0;
  std::vector<Homogeneous> value, slope;

  Line(const Surface& surface, int low_index, int high_index, double v) : low(low_index) {
    const BasisValues b = evaluate_basis(surface.v_knots(), v, 1);
    const auto count = static_cast<size_t>(high_index - low_index) + 1;
    value.reserve(count);
    slope.reserve(count);
    for (int i = low_index; i <= high_index; ++i) {
      Homogeneous at, derivative;
      for (int j = 0; j <= b.degree; ++j) {
        const size_t k = surface.index(i, b.first + j);
        const double w = surface.rational() ? surface.weights()[k] : 1.0;
        const Vec3& p = surface.poles()[k];
        const Homogeneous h{w * p.x(), w * p.y(), w * p.z(), w};
        at.add(b.value(0, j), h);
        derivative.add(b.value(1, j), h);
      }
      value.push_back(at);
      slope.push_back(derivative);
    }
  }
};

template <typename Kind>
FluxIntegrand<Kind>::FluxIntegrand(const Handle(Geom_Surface) & surface, const Kind& kind)
    : surface_(surface), kind_(kind), breaks_(surface_breaks(surface)) {
  const GeomAdaptor_Surface adaptor(surface);
  switch (adaptor.GetType()) {
    case GeomAbs_Plane:
      polynomial_ = plane_ = true;
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
  polynomial_ = polynomial_ && exact_points() <= kMaxPoints;
  angular_u_ = u_degree_ <= 1 && adaptor.IsUPeriodic();
  least_u_step_ = least_step(breaks_.u);
  least_v_step_ = least_step(breaks_.v);
  if (surface->IsUPeriodic()) repeat_breaks(breaks_.u, surface->UPeriod());
  if (surface->IsVPeriodic()) repeat_breaks(breaks_.v, surface->VPeriod());
  const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface);
  if (!spline.IsNull() && !spline->IsUPeriodic() && !spline->IsVPeriodic()) {
    spline_ = from_occt(*spline);
  }
}

template <typename Kind>
typename FluxIntegrand<Kind>::Table FluxIntegrand<Kind>::table_of(int points) const {
  Table table{unit_rule(points), {}, {}};
  if (!spline_) return table;
  const KnotVector& knots = spline_->u_knots();
  for (int span : knots.spans()) {
    const Table part = partial_table(knots, span, knots[span], knots[span + 1], table.rule);
    table.values.insert(table.values.end(), part.values.begin(), part.values.end());
    table.slopes.insert(table.slopes.end(), part.slopes.begin(), part.slopes.end());
  }
  return table;
}

template <typename Kind>
void FluxIntegrand<Kind>::prepare(double low, double high, double v_low, double v_high) {
  double start = 0.5 * (low + high);
  // From a knot there are only whole spans, which are tabulated, and one partial one.
  double best = std::numeric_limits<double>::infinity();
  const double middle = start;
  for (double at : breaks_.u) {
    if (low < at && at < high && std::abs(at - middle) < best) {
      best = std::abs(at - middle);
      start = at;
    }
  }
  prepare_at(start, high, v_low, v_high);
}

template <typename Kind>
void FluxIntegrand<Kind>::prepare_at(double start, double u_end, double v_low, double v_high) {
  start_ = start;
  choose_rules(u_end, v_low, v_high);
}

template <typename Kind>
void FluxIntegrand<Kind>::choose_rules(double u_end, double v_low, double v_high) {
  const int exact = std::min(exact_points(), kMaxPoints);
  if (polynomial_) {
    rule_ = table_of(std::max(exact, plane_ ? 2 : Kind::kLeastPoints));
    fine_rule_ = rule_;
    return;
  }
  fine_rule_ = table_of(std::max(exact, kFinePoints));
  // Weights that hardly vary need little more than a polynomial of the same degree.
  for (int points = std::max(exact, Kind::kLeastPoints) + 2;; points += 3) {
    rule_ = table_of(points);
    if (points >= std::max(exact, kSmoothPoints)) return;
    double change = 0.0;
    double size = 0.0;
    for (double s : {0.07, 0.31, 0.52, 0.77, 0.96}) {
      const double v = v_low + s * (v_high - v_low);
      const Sums coarse = inner(u_end, v, false);
      const Sums fine = inner(u_end, v, true);
      change = std::max(change, fine.distance(coarse));
      size = std::max(size, static_cast<double>(fine.size));
    }
    if (change <= kRuleTest * size) break;
  }
  // The other half of the face is judged by the pieces, with three more points.
  fine_rule_ = table_of(static_cast<int>(rule_.rule.nodes.size()) + 3);
}

template <typename Kind>
inline void FluxIntegrand<Kind>::add_point(const gp_Pnt& p, const gp_Vec& du, const gp_Vec& dv,
                                           double w, Sums& sums) const {
  // Positions are good to eps |p|, derivatives to eps |p| per step of the knots.
  const double reach = std::abs(p.X()) + std::abs(p.Y()) + std::abs(p.Z());
  const double speed_u = du.Magnitude();
  const double speed_v = dv.Magnitude();
  kind_.add({p, du, dv, speed_u, speed_v, reach, speed_u + u_degree_ * reach / least_u_step_,
             speed_v + v_degree_ * reach / least_v_step_},
            w, sums);
}

template <typename Kind>
void FluxIntegrand<Kind>::add_piece(double from, double to, double v, const UnitRule& rule,
                                    double sign, Sums& sums) const {
  gp_Pnt p;
  gp_Vec du, dv;
  for (size_t k = 0; k < rule.nodes.size(); ++k) {
    surface_->D1(from + (to - from) * rule.nodes[k], v, p, du, dv);
    add_point(p, du, dv, sign * (to - from) * rule.weights[k], sums);
  }
}

// Basis functions of one span at `points` Gauss points, times the poles of a line: for all points
// at once, so that the compiler can use vectors.
template <typename Kind>
inline void FluxIntegrand<Kind>::contract(const double* basis, const Homogeneous* poles,
                                          size_t functions, size_t points, bool rational,
                                          Coordinates& out) {
  for (auto& coordinate : out) std::fill_n(coordinate.begin(), points, 0.0);
  for (size_t j = 0; j < functions; ++j) {
    const Homogeneous& h = poles[j];
    const double* b = basis + j * points;
    for (size_t k = 0; k < points; ++k) out[0][k] += b[k] * h.x;
    for (size_t k = 0; k < points; ++k) out[1][k] += b[k] * h.y;
    for (size_t k = 0; k < points; ++k) out[2][k] += b[k] * h.z;
    if (!rational) continue;
    for (size_t k = 0; k < points; ++k) out[3][k] += b[k] * h.w;
  }
}

// The basis functions of one span between two of its parameters.
template <typename Kind>
typename FluxIntegrand<Kind>::Table FluxIntegrand<Kind>::partial_table(const KnotVector& knots,
                                                                       int span, double from,
                                                                       double to,
                                                                       const UnitRule& rule) {
  const size_t points = rule.nodes.size();
  const auto functions = static_cast<size_t>(knots.degree()) + 1;
  Table table;
  table.values.resize(functions * points);
  table.slopes.resize(functions * points);
  for (size_t k = 0; k < points; ++k) {
    const BasisValues b =
        evaluate_basis_on_span(knots, span, from + (to - from) * rule.nodes[k], 1);
    for (size_t j = 0; j < functions; ++j) {
      table.values[j * points + k] = b.value(0, static_cast<int>(j));
      table.slopes[j * points + k] = b.value(1, static_cast<int>(j));
    }
  }
  return table;
}

template <typename Kind>
void FluxIntegrand<Kind>::add_span(const Line& line, int ordinal, double from, double to,
                                   double sign, const Table& table, Sums& sums) const {
  const KnotVector& knots = spline_->u_knots();
  const int span = knots.spans()[static_cast<size_t>(ordinal)];
  const auto functions = static_cast<size_t>(knots.degree()) + 1;
  const size_t points = table.rule.nodes.size();
  ISOCHOR_REQUIRE(points <= kMostPoints, points);
  const bool whole = from == knots[span] && to == knots[span + 1];
  Table partial;
  if (!whole) partial = partial_table(knots, span, from, to, table.rule);
  const size_t offset = whole ? static_cast<size_t>(ordinal) * functions * points : 0;
  const double* values = (whole ? table : partial).values.data() + offset;
  const double* slopes = (whole ? table : partial).slopes.data() + offset;
  const auto first = static_cast<size_t>(span - knots.degree() - line.low);
  const bool rational = spline_->rational();
  Coordinates s, su, sv;
  contract(values, &line.value[first], functions, points, rational, s);
  contract(slopes, &line.value[first], functions, points, rational, su);
  contract(values, &line.slope[first], functions, points, rational, sv);
  for (size_t k = 0; k < points; ++k) {
    const double weight = sign * (to - from) * table.rule.weights[k];
    if (!rational) {
      add_point({s[0][k], s[1][k], s[2][k]}, {su[0][k], su[1][k], su[2][k]},
                {sv[0][k], sv[1][k], sv[2][k]}, weight, sums);
      continue;
    }
    const double w = s[3][k];
    const gp_Pnt p(s[0][k] / w, s[1][k] / w, s[2][k] / w);
    const gp_Vec du((su[0][k] - su[3][k] * p.X()) / w, (su[1][k] - su[3][k] * p.Y()) / w,
                    (su[2][k] - su[3][k] * p.Z()) / w);
    const gp_Vec dv((sv[0][k] - sv[3][k] * p.X()) / w, (sv[1][k] - sv[3][k] * p.Y()) / w,
                    (sv[2][k] - sv[3][k] * p.Z()) / w);
    add_point(p, du, dv, weight, sums);
  }
}

template <typename Kind>
typename Kind::Sums FluxIntegrand<Kind>::line(double u, double v, const Table& table) const {
  Sums sums;
  const double low = std::min(start_, u);
  const double high = std::max(start_, u);
  if (!(low < high)) return sums;
  const double sign = u >= start_ ? 1.0 : -1.0;
  const KnotVector& knots = spline_->u_knots();
  const int first_span = knots.span_of(low);
  const int last_span = knots.span_of(high);
  const Line contracted(*spline_, first_span - knots.degree(), last_span, v);
  const std::vector<int>& spans = knots.spans();
  for (size_t k = 0; k < spans.size(); ++k) {
    const int span = spans[k];
    if (span < first_span || span > last_span) continue;
    // The end spans go on beyond the domain.
    const double from = span == first_span ? low : knots[span];
    const double to = span == last_span ? high : knots[span + 1];
    if (from < to) add_span(contracted, static_cast<int>(k), from, to, sign, table, sums);
  }
  return sums;
}

template <typename Kind>
typename Kind::Sums FluxIntegrand<Kind>::inner(double u, double v, bool fine) const {
  const Table& table = fine ? fine_rule_ : rule_;
  if (spline_) return line(u, v, table);
  const double low = std::min(start_, u);
  const double high = std::max(start_, u);
  const double sign = u >= start_ ? 1.0 : -1.0;
  Sums sums;
  for_each_smooth_piece(breaks_.u, low, high, angular_u_, [&](double begin, double end) {
    add_piece(begin, end, v, table.rule, sign, sums);
  });
  return sums;
}

template class FluxIntegrand<FluxKind>;
template class FluxIntegrand<MomentKind>;

}  // namespace isochor::internal
