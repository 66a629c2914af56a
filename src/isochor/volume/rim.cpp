#include "isochor/volume/rim.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/exact/rational.h"
#include "isochor/volume/gauss_remainder.h"
#include "isochor/volume/span_polynomials.h"

namespace isochor::internal {
namespace {

// One coefficient of a side's curve, exactly: point -> share; weights beside the shares.
struct ExactCoefficient {
  std::map<int, Rational> shares;
  friend bool operator==(const ExactCoefficient& a, const ExactCoefficient& b) {
    return a.shares == b.shares;
  }
};

// A side, with everything that decides whether two sides are the same curve.
struct ExactSide {
  size_t patch = 0;
  bool along_v = false;
  double sign = 1.0;  // of its integral of x dy in the sum for A
  std::vector<ExactCoefficient> coefficients;
  std::vector<Rational> knots;  // of the running direction, mapped to [0, 1]
};

// The functions that are nonzero at one end of the domain, as (index, exact value).
std::vector<std::pair<int, Rational>> end_values(const KnotVector& knots, bool at_begin) {
  if (at_begin ? knots.clamped_begin() : knots.clamped_end()) {
    return {{at_begin ? 0 : knots.size() - 1, Rational(1)}};
  }
  const SpanPolynomials polynomials(knots);
  const int s = at_begin ? 0 : polynomials.spans() - 1;
  std::vector<std::pair<int, Rational>> values;
  for (int j = 0; j <= knots.degree(); ++j) {
    Integer sum;
    for (int k = 0; k <= (at_begin ? 0 : knots.degree()); ++k) {
      sum += polynomials.coefficient(s, j, k);
    }
    if (!sum.is_zero()) {
      values.emplace_back(polynomials.first(s) + j, Rational(sum, polynomials.denominator(s)));
    }
  }
  return values;
}

ExactSide describe(const Patch& patch, const PatchForm& form, size_t index, Side side) {
  ExactSide result;
  result.patch = index;
  result.along_v = is_u_side(side);
  // Counter-clockwise in (u, v): along v0 and u1 with the parameter, along v1 and u0 against it.
  const bool with_parameter = side == Side::kVBegin || side == Side::kUEnd;
  result.sign = with_parameter ? patch.sign() : -patch.sign();
  const KnotVector& across = result.along_v ? patch.u_knots : patch.v_knots;
  const KnotVector& along = result.along_v ? patch.v_knots : patch.u_knots;
  const auto rows = end_values(across, is_begin_side(side));
  for (int k = 0; k < along.size(); ++k) {
    ExactCoefficient coefficient;
    for (const auto& [row, share] : rows) {
      const int at = result.along_v ? row * patch.v_size() + k : k * patch.v_size() + row;
      const double w = form.rational() ? form.weights[static_cast<size_t>(at)] : 1.0;
      coefficient.shares[patch.points[static_cast<size_t>(at)]] += share * Rational(w);
    }
    result.coefficients.push_back(std::move(coefficient));
  }
  const Rational begin(along.begin());
  const Rational length = Rational(along.end()) - begin;
  for (double t : along.knots()) result.knots.push_back((Rational(t) - begin) / length);
  return result;
}

bool is_one_point(const ExactSide& side) {
  const auto& first = side.coefficients.front().shares;
  return first.size() == 1 &&
         std::all_of(side.coefficients.begin(), side.coefficients.end(), [&](const auto& each) {
           return each.shares.size() == 1 && each.shares.begin()->first == first.begin()->first;
         });
}

bool same_curve_forward(const ExactSide& a, const ExactSide& b) {
  return a.coefficients == b.coefficients && a.knots == b.knots;
}

bool same_curve_backward(const ExactSide& a, const ExactSide& b) {
  const size_t n = a.coefficients.size();
  const size_t m = a.knots.size();
  if (b.coefficients.size() != n || b.knots.size() != m) return false;
  for (size_t k = 0; k < n; ++k) {
    if (!(a.coefficients[k] == b.coefficients[n - 1 - k])) return false;
  }
  for (size_t k = 0; k < m; ++k) {
    if (a.knots[k] + b.knots[m - 1 - k] != Rational(1)) return false;
  }
  return true;
}

bool cancel(const ExactSide& a, const ExactSide& b) {
  if (a.sign != b.sign && same_curve_forward(a, b)) return true;
  return a.sign == b.sign && same_curve_backward(a, b);
}

// A number that equal sides share, whatever their sense.
long fingerprint(const ExactSide& side) {
  long sum = 0;
  for (const auto& coefficient : side.coefficients) {
    for (const auto& share : coefficient.shares) sum += share.first;
  }
  return sum;
}

std::vector<ExactSide> remaining_sides(const PatchModel& model,
                                       const std::vector<PatchForm>& forms) {
  std::multimap<long, ExactSide> open;
  for (size_t q = 0; q < model.patches.size(); ++q) {
    for (Side which : kSides) {
      ExactSide side = describe(model.patches[q], forms[q], q, which);
      if (is_one_point(side)) continue;
      const long key = fingerprint(side);
      auto [at, end] = open.equal_range(key);
      while (at != end && !cancel(at->second, side)) ++at;
      if (at != end) {
        open.erase(at);
      } else {
        open.emplace(key, std::move(side));
      }
    }
  }
  std::vector<ExactSide> sides;
  for (auto& entry : open) sides.push_back(std::move(entry.second));
  return sides;
}

// What the table's cells of a span may miss of the integral of x dy.
double remainder_of(const SpanTable& table, const std::vector<double>& weights, int s) {
  double sum = 0.0;
  for (const Cell& cell : table.cells()[static_cast<size_t>(s)]) {
    const WeightNet net = part_of(net_of(table.knots(), weights, s), cell.begin, cell.end);
    sum += GaussRemainder(net, Integrand::kArea).bound(cell.gauss_points);
  }
  return sum;
}

}  // namespace

Rim::Rim(const PatchModel& model, const std::vector<PatchForm>& forms, double x_origin)
    : x_origin_(x_origin) {
  for (const ExactSide& side : remaining_sides(model, forms)) {
    const PatchForm& form = forms[side.patch];
    Curve curve;
    curve.table = side.along_v ? form.v : form.u;
    curve.sign = side.sign;
    for (const ExactCoefficient& coefficient : side.coefficients) {
      std::vector<Share> shares;
      double weight = 0.0;
      for (const auto& [point, share] : coefficient.shares) {
        shares.push_back({point, share.to_double()});
        weight += shares.back().factor;
      }
      curve.coefficients.push_back(std::move(shares));
      if (form.rational()) curve.weights.push_back(weight);
    }
    for (int s = 0; form.rational() && s < curve.table->spans(); ++s) {
      curve.remainders.push_back(remainder_of(*curve.table, curve.weights, s));
    }
    // As in element_integrals.cpp, with d + 4 for the shares that make up a coefficient.
    const double shares = curve.table->degree() + 4.0;
    const double table = table_roundoffs(curve.table->degree());
    const double denominator = table + curve.table->degree() + 2.0 + shares;
    const double numerator = denominator + 3.0;
    const double functions =
        form.rational() ? 2.0 * numerator + 4.0 * denominator + 8.0 : 2.0 * numerator;
    const double count = functions + 10.0 + table + curve.table->gauss_points();
    rounding_factor_ = std::max(rounding_factor_, 1.01 * count * kUnitRoundoff);
    curves_.push_back(std::move(curve));
  }
}

std::vector<RimElement> Rim::elements() const {
  std::vector<RimElement> all;
  for (size_t c = 0; c < curves_.size(); ++c) {
    for (int s = 0; s < curves_[c].table->spans(); ++s) all.push_back({static_cast<int>(c), s});
  }
  return all;
}

std::vector<RimElement> Rim::elements_of(const std::vector<int>& row_of) const {
  std::vector<RimElement> chosen;
  for (const RimElement& at : elements()) {
    const Curve& curve = curves_[static_cast<size_t>(at.curve)];
    const auto first = curve.coefficients.begin() + curve.table->first(at.span);
    const bool touched = std::any_of(first, first + curve.table->degree() + 1, [&](const auto& c) {
      return std::any_of(c.begin(), c.end(), [&](const Share& share) {
        return row_of[static_cast<size_t>(share.point)] >= 0;
      });
    });
    if (touched) chosen.push_back(at);
  }
  return chosen;
}

void Rim::evaluate(const RimElement& at, const std::vector<Vec3>& vectors, int axis, double origin,
                   bool sizes, Values& out) const {
  const Curve& curve = curves_[static_cast<size_t>(at.curve)];
  const SpanTable& table = *curve.table;
  const auto count = static_cast<size_t>(table.gauss_points(at.span));
  out.value.assign(count, 0.0);
  out.slope.assign(count, 0.0);
  std::vector<double> w(count, 0.0);
  std::vector<double> dw(count, 0.0);
  for (int j = 0; j <= table.degree(); ++j) {
    const auto index = static_cast<size_t>(table.first(at.span) + j);
    double c = 0.0;
    for (const Share& share : curve.coefficients[index]) {
      const double x = vectors[static_cast<size_t>(share.point)][axis] - origin;
      c += share.factor * (sizes ? std::abs(x) : x);
    }
    const double weight = curve.weights.empty() ? 0.0 : curve.weights[index];
    const double* b = table.values(at.span, j);
    const double* db = sizes ? table.slope_sizes(at.span, j) : table.slopes(at.span, j);
    for (size_t g = 0; g < count; ++g) {
      out.value[g] += c * b[g];
      out.slope[g] += c * db[g];
      w[g] += weight * b[g];
      dw[g] += weight * db[g];
    }
  }
  if (curve.weights.empty()) return;
  const double sense = sizes ? -1.0 : 1.0;
  for (size_t g = 0; g < count; ++g) {
    out.value[g] /= w[g];
    out.slope[g] = (out.slope[g] - sense * dw[g] * out.value[g]) / w[g];
  }
}

double Rim::area(const std::vector<Vec3>& points, const std::vector<RimElement>& elements,
                 bool sizes) const {
  double sum = 0.0;
  Values x;
  Values y;
  for (const RimElement& at : elements) {
    const Curve& curve = curves_[static_cast<size_t>(at.curve)];
    evaluate(at, points, 0, x_origin_, sizes, x);
    const double reference = points[static_cast<size_t>(curve.coefficients[0][0].point)].y();
    evaluate(at, points, 1, reference, sizes, y);
    const double* w = curve.table->weights(at.span);
    double element = 0.0;
    for (size_t g = 0; g < x.value.size(); ++g) element += w[g] * x.value[g] * y.slope[g];
    sum += (sizes ? 1.0 : curve.sign) * element;
  }
  return sum;
}

std::array<double, 2> Rim::area_line(const std::vector<Vec3>& points,
                                     const std::vector<Vec3>& directions,
                                     const std::vector<RimElement>& elements, bool sizes) const {
  std::array<double, 2> sum{};
  Values x, y, dx, dy;
  for (const RimElement& at : elements) {
    const Curve& curve = curves_[static_cast<size_t>(at.curve)];
    evaluate(at, points, 0, x_origin_, sizes, x);
    const double reference = points[static_cast<size_t>(curve.coefficients[0][0].point)].y();
    evaluate(at, points, 1, reference, sizes, y);
    evaluate(at, directions, 0, 0.0, sizes, dx);
    evaluate(at, directions, 1, 0.0, sizes, dy);
    const double* w = curve.table->weights(at.span);
    const double sign = sizes ? 1.0 : curve.sign;
    for (size_t g = 0; g < x.value.size(); ++g) {
      sum[0] += sign * w[g] * (dx.value[g] * y.slope[g] + x.value[g] * dy.slope[g]);
      sum[1] += sign * w[g] * (dx.value[g] * dy.slope[g]);
    }
  }
  return sum;
}

std::array<double, 2> Rim::radii(const RimElement& at, const std::vector<Vec3>& vectors,
                                 double origin) const {
  const Curve& curve = curves_[static_cast<size_t>(at.curve)];
  const int first = curve.table->first(at.span);
  double x = 0.0;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (int j = first; j <= first + curve.table->degree(); ++j) {
    for (const Share& share : curve.coefficients[static_cast<size_t>(j)]) {
      const Vec3& p = vectors[static_cast<size_t>(share.point)];
      x = std::max(x, std::abs(p.x() - origin));
      low = std::min(low, p.y());
      high = std::max(high, p.y());
    }
  }
  return {x, 0.5 * (high - low)};
}

double Rim::area_remainder(const std::vector<Vec3>& points,
                           const std::vector<RimElement>& elements) const {
  double sum = 0.0;
  for (const RimElement& at : elements) {
    const Curve& curve = curves_[static_cast<size_t>(at.curve)];
    if (curve.remainders.empty()) continue;
    const auto r = radii(at, points, x_origin_);
    sum += curve.remainders[static_cast<size_t>(at.span)] * r[0] * r[1];
  }
  return sum;
}

double Rim::change_remainder(const std::vector<Vec3>& points, const std::vector<Vec3>& directions,
                             const std::vector<RimElement>& elements) const {
  double sum = 0.0;
  for (const RimElement& at : elements) {
    const Curve& curve = curves_[static_cast<size_t>(at.curve)];
    if (curve.remainders.empty()) continue;
    const auto r = radii(at, points, x_origin_);
    const auto d = radii(at, directions, 0.0);
    sum += curve.remainders[static_cast<size_t>(at.span)] * (d[0] * r[1] + (r[0] + d[0]) * d[1]);
  }
  return sum;
}

void Rim::add_area_gradient(const std::vector<Vec3>& points,
                            const std::vector<RimElement>& elements, const std::vector<int>& row_of,
                            double scale, std::vector<Vec3>& rows) const {
  Values x;
  Values y;
  for (const RimElement& at : elements) {
    const Curve& curve = curves_[static_cast<size_t>(at.curve)];
    const SpanTable& table = *curve.table;
    evaluate(at, points, 0, x_origin_, false, x);
    const double reference = points[static_cast<size_t>(curve.coefficients[0][0].point)].y();
    evaluate(at, points, 1, reference, false, y);
    // Denominator and its slope; one and zero without weights.
    std::vector<double> w(x.value.size(), curve.weights.empty() ? 1.0 : 0.0);
    std::vector<double> dw(x.value.size(), 0.0);
    for (int j = 0; j <= table.degree() && !curve.weights.empty(); ++j) {
      const double weight = curve.weights[static_cast<size_t>(table.first(at.span) + j)];
      for (size_t g = 0; g < w.size(); ++g) {
        w[g] += weight * table.values(at.span, j)[g];
        dw[g] += weight * table.slopes(at.span, j)[g];
      }
    }
    for (int j = 0; j <= table.degree(); ++j) {
      double by_x = 0.0;
      double by_y = 0.0;
      for (size_t g = 0; g < w.size(); ++g) {
        const double value = table.values(at.span, j)[g] / w[g];
        const double slope = (table.slopes(at.span, j)[g] - dw[g] * value) / w[g];
        by_x += table.weights(at.span)[g] * value * y.slope[g];
        by_y += table.weights(at.span)[g] * x.value[g] * slope;
      }
      for (const Share& share : curve.coefficients[static_cast<size_t>(table.first(at.span) + j)]) {
        const int row = row_of[static_cast<size_t>(share.point)];
        if (row < 0) continue;
        rows[static_cast<size_t>(row)].x() += scale * curve.sign * share.factor * by_x;
        rows[static_cast<size_t>(row)].y() += scale * curve.sign * share.factor * by_y;
      }
    }
  }
}

void Rim::add_flux_gradient(const std::vector<Vec3>& points,
                            const std::vector<RimElement>& elements, const std::vector<int>& row_of,
                            double height, std::vector<Vec3>& rows) const {
  Values x, y, z;
  for (const RimElement& at : elements) {
    const Curve& curve = curves_[static_cast<size_t>(at.curve)];
    const SpanTable& table = *curve.table;
    ISOCHOR_REQUIRE(curve.weights.empty(), at.curve);
    const Vec3& reference = points[static_cast<size_t>(curve.coefficients[0][0].point)];
    evaluate(at, points, 0, reference.x(), false, x);
    evaluate(at, points, 1, reference.y(), false, y);
    evaluate(at, points, 2, height, false, z);
    for (int j = 0; j <= table.degree(); ++j) {
      double by_x = 0.0, by_y = 0.0;
      for (size_t g = 0; g < z.value.size(); ++g) {
        const double flux = table.weights(at.span)[g] * table.values(at.span, j)[g] * z.value[g];
        by_x += flux * y.slope[g];
        by_y -= flux * x.slope[g];
      }
      for (const Share& share : curve.coefficients[static_cast<size_t>(table.first(at.span) + j)]) {
        const int row = row_of[static_cast<size_t>(share.point)];
        if (row < 0) continue;
        rows[static_cast<size_t>(row)].x() += curve.sign * share.factor * by_x;
        rows[static_cast<size_t>(row)].y() += curve.sign * share.factor * by_y;
      }
    }
  }
}

}  // namespace isochor::internal
