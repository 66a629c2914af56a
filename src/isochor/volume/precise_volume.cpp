#include "isochor/volume/precise_volume.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/volume/tau_tensor.h"

namespace isochor {
namespace {

// Relative errors are counted in units of DoubleDouble::kUnit; see docs/volume.md, "Rounding". The
// entries of the two tensors take most of this allowance, which holds for all degrees up to 25.
constexpr double kPreciseSteps = 0x1p21;

// The two kinds of numbers that the sums below are made of: values, and sizes that bound them.
struct Values {
  using Number = DoubleDouble;
  static Number difference(double a, double b) { return DoubleDouble(a) - DoubleDouble(b); }
  static Number minor(const Number& a, const Number& d, const Number& b, const Number& c) {
    return a * d - b * c;
  }
};
struct Sizes {
  using Number = double;
  static Number difference(double a, double b) { return std::abs(a - b); }
  static Number minor(Number a, Number d, Number b, Number c) { return a * d + b * c; }
};

// iint B_i B_j (x_u y_v - x_v y_u) of one patch for any two of its coordinates (x, y).
template <typename Kind>
class Areas {
 public:
  using Number = typename Kind::Number;

  Areas(const Patch& patch, const std::vector<Vec3>& points)
      : patch_(patch), points_(points), u_(patch.u_knots), v_(patch.v_knots) {}

  // One number per pole, u-major.
  std::vector<Number> column(int x, int y) const {
    const int n = u_.size(), m = v_.size(), d = u_.degree();
    std::vector<Number> areas(static_cast<size_t>(n) * m, Number(0.0));
    for (int k = 0; k < n; ++k) {
      const auto dx = pairs(k, x), dy = pairs(k, y);
      for (int j = std::max(0, k - d); j <= std::min(n - 2, k + d - 1); ++j) {
        const auto met = meet(j, x, y, dx, dy);
        const int low = std::max({0, k - d, j - d + 1});
        const int high = std::min({n - 1, k + d, j + d});
        for (int i = low; i <= high; ++i) {
          const Number factor = u_(i, k, j);
          Number* row = &areas[static_cast<size_t>(i) * m];
          for (int c = 0; c < m; ++c) row[c] += factor * met[static_cast<size_t>(c)];
        }
      }
    }
    return areas;
  }

 private:
  double pole(int i, int j, int axis) const {
    return points_[static_cast<size_t>(patch_.point(i, j))][axis];
  }

  // D(o, i) = sum over j of tau^v_ikj (p_{row,j+1} - p_{row,j}) with k = i + o - e.
  std::vector<Number> pairs(int row, int axis) const {
    const int m = v_.size(), e = v_.degree();
    std::vector<Number> steps, sums(static_cast<size_t>(2 * e + 1) * m, Number(0.0));
    for (int j = 0; j + 1 < m; ++j) {
      steps.push_back(Kind::difference(pole(row, j + 1, axis), pole(row, j, axis)));
    }
    for (int o = 0; o <= 2 * e; ++o) {
      for (int s = std::max(0, o - e); s < std::min(2 * e, o + e); ++s) {
        const Number* tau = v_.band(o, s);
        const int from = std::max(0, e - s), to = std::min(m, m - 1 + e - s);
        for (int i = from; i < to; ++i) {
          sums[static_cast<size_t>(o * m + i)] += tau[i] * steps[static_cast<size_t>(i + s - e)];
        }
      }
    }
    return sums;
  }

  // T_i = sum over k of the cross product of p_{j+1,k} - p_jk with D(., i).
  std::vector<Number> meet(int j, int x, int y, const std::vector<Number>& dx,
                           const std::vector<Number>& dy) const {
    const int m = v_.size(), e = v_.degree();
    std::vector<Number> fx, fy, sums(static_cast<size_t>(m), Number(0.0));
    for (int k = 0; k < m; ++k) {
      fx.push_back(Kind::difference(pole(j + 1, k, x), pole(j, k, x)));
      fy.push_back(Kind::difference(pole(j + 1, k, y), pole(j, k, y)));
    }
    for (int o = 0; o <= 2 * e; ++o) {
      const int from = std::max(0, e - o), to = std::min(m, m + e - o);
      for (int i = from; i < to; ++i) {
        const auto at = static_cast<size_t>(o * m + i), k = static_cast<size_t>(i + o - e);
        sums[static_cast<size_t>(i)] += Kind::minor(fx[k], dy[at], fy[k], dx[at]);
      }
    }
    return sums;
  }

  const Patch& patch_;
  const std::vector<Vec3>& points_;
  BasicTauTensor<Number> u_, v_;
};

void require_polynomial(const Patch& patch) {
  const auto& w = patch.weights;
  ISOCHOR_REQUIRE(std::all_of(w.begin(), w.end(), [&](double each) { return each == w[0]; }),
                  patch.handle);
}

// The knots that the spans [first, last] (ordinals of non-empty spans) need, and the first
// function.
std::pair<KnotVector, int> cut(const KnotVector& knots, int first, int last) {
  const int begin = knots.spans()[static_cast<size_t>(first)] - knots.degree();
  const int end = knots.spans()[static_cast<size_t>(last)] + 1;
  const auto from = knots.knots().begin() + begin;
  const auto to = knots.knots().begin() + end + knots.degree() + 1;
  return {KnotVector(knots.degree(), {from, to}), begin};
}

// The first and last span on which function i lives.
std::pair<int, int> spans_of(const KnotVector& knots, int i) {
  const auto& spans = knots.spans();
  const auto first = std::lower_bound(spans.begin(), spans.end(), i);
  const auto last = std::upper_bound(spans.begin(), spans.end(), i + knots.degree());
  return {static_cast<int>(first - spans.begin()), static_cast<int>(last - spans.begin()) - 1};
}

// The part of the patch under the poles that differ; without points when there are none.
Patch touched_part(const Patch& patch, const std::vector<Vec3>& before,
                   const std::vector<Vec3>& after) {
  int u_first = patch.u_size(), u_last = -1, v_first = patch.v_size(), v_last = -1;
  for (int i = 0; i < patch.u_size(); ++i) {
    for (int j = 0; j < patch.v_size(); ++j) {
      const auto id = static_cast<size_t>(patch.point(i, j));
      if (before[id] == after[id]) continue;
      const auto [u0, u1] = spans_of(patch.u_knots, i);
      const auto [v0, v1] = spans_of(patch.v_knots, j);
      if (u0 > u1 || v0 > v1) continue;  // a function that is zero on the whole domain
      u_first = std::min(u_first, u0), u_last = std::max(u_last, u1);
      v_first = std::min(v_first, v0), v_last = std::max(v_last, v1);
    }
  }
  Patch part = patch;
  part.points.clear();
  if (u_last < 0) return part;
  const auto [u_knots, i0] = cut(patch.u_knots, u_first, u_last);
  const auto [v_knots, j0] = cut(patch.v_knots, v_first, v_last);
  part.u_knots = u_knots;
  part.v_knots = v_knots;
  for (int i = 0; i < u_knots.size(); ++i) {
    for (int j = 0; j < v_knots.size(); ++j) part.points.push_back(patch.point(i0 + i, j0 + j));
  }
  return part;
}

// Sums of double-double numbers carry a relative error of their terms' sizes.
double sum_bound(const PreciseNumber& a, const PreciseNumber& b) {
  const double size = std::abs(a.value.high()) + std::abs(b.value.high());
  return (a.bound + b.bound + 2.0 * DoubleDouble::kUnit * size) * (1.0 + 8.0 * kUnitRoundoff);
}

}  // namespace

Bounded PreciseNumber::rounded() const {
  // 1.01 covers the roundings of this sum itself.
  return {value.high(), 1.01 * (std::abs(value.low()) + bound)};
}

PreciseNumber operator+(const PreciseNumber& a, const PreciseNumber& b) {
  return {a.value + b.value, sum_bound(a, b)};
}

PreciseNumber operator-(const PreciseNumber& a, const PreciseNumber& b) {
  return {a.value - b.value, sum_bound(a, b)};
}

double contraction_majorant(const Patch& patch, const std::vector<Vec3>& points, double height) {
  require_polynomial(patch);
  const std::vector<double> areas = Areas<Sizes>(patch, points).column(0, 1);
  double sum = 0.0;
  for (size_t k = 0; k < areas.size(); ++k) {
    sum += std::abs(points[static_cast<size_t>(patch.points[k])].z() - height) * areas[k];
  }
  // All terms are non-negative: a few thousand roundings each, and one for every term.
  return sum * (1.001 + 4.0 * kUnitRoundoff * static_cast<double>(areas.size()));
}

PreciseNumber precise_flux(const Patch& patch, const std::vector<Vec3>& points) {
  require_polynomial(patch);
  const std::vector<DoubleDouble> areas = Areas<Values>(patch, points).column(0, 1);
  DoubleDouble sum;
  for (size_t k = 0; k < areas.size(); ++k) {
    sum += DoubleDouble(points[static_cast<size_t>(patch.points[k])].z()) * areas[k];
  }
  const double steps = kPreciseSteps + static_cast<double>(areas.size());
  return {patch.reversed ? -sum : sum,
          steps * DoubleDouble::kUnit * contraction_majorant(patch, points, 0.0)};
}

PreciseNumber precise_flux_change(const Patch& patch, const std::vector<Vec3>& before,
                                  const std::vector<Vec3>& after) {
  ISOCHOR_REQUIRE(before.size() == after.size(), before.size(), after.size());
  require_polynomial(patch);
  const Patch part = touched_part(patch, before, after);
  if (part.points.empty()) return {};
  return precise_flux(part, after) - precise_flux(part, before);
}

std::vector<std::array<DoubleDouble, 3>> precise_areas(const Patch& patch,
                                                       const std::vector<Vec3>& points) {
  require_polynomial(patch);
  const Areas<Values> areas(patch, points);
  std::vector<std::array<DoubleDouble, 3>> rows(patch.points.size());
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto column =
        areas.column(static_cast<int>((axis + 1) % 3), static_cast<int>((axis + 2) % 3));
    for (size_t k = 0; k < rows.size(); ++k) {
      rows[k][axis] = patch.reversed ? -column[k] : column[k];
    }
  }
  return rows;
}

}  // namespace isochor
