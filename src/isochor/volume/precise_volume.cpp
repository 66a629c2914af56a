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
  static Number difference(const Number& a, const Number& b) { return a - b; }
  static Number minor(const Number& a, const Number& d, const Number& b, const Number& c) {
    return a * d - b * c;
  }
};
struct Sizes {
  using Number = double;
  // Never below the size of the difference of the two numbers of which a and b are roundings.
  static Number difference(double a, double b) {
    return std::abs(a - b) + 4.0 * kUnitRoundoff * (std::abs(a) + std::abs(b));
  }
  static Number minor(Number a, Number d, Number b, Number c) { return a * d + b * c; }
};

// One number per pole, u-major.
template <typename Kind>
using Field = std::vector<typename Kind::Number>;

// iint B_i B_j (x_u y_v - x_v y_u) of a patch for functions x and y given by their poles.
template <typename Kind>
class Areas {
 public:
  using Number = typename Kind::Number;

  explicit Areas(const Patch& patch) : u_(patch.u_knots), v_(patch.v_knots) {}

  Field<Kind> operator()(const Field<Kind>& x, const Field<Kind>& y) const {
    const int n = u_.size(), m = v_.size(), d = u_.degree();
    Field<Kind> areas(static_cast<size_t>(n) * m, Number(0.0));
    for (int k = 0; k < n; ++k) {
      const auto dx = pairs(k, x), dy = pairs(k, y);
      for (int j = std::max(0, k - d); j <= std::min(n - 2, k + d - 1); ++j) {
        const auto met = meet(row_steps(j, x), row_steps(j, y), dx, dy);
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
  // D(o, i) = sum over j of tau^v_ikj (f_{row,j+1} - f_{row,j}) with k = i + o - e.
  Field<Kind> pairs(int row, const Field<Kind>& f) const {
    const int m = v_.size(), e = v_.degree();
    const Number* at = &f[static_cast<size_t>(row) * m];
    Field<Kind> steps, sums(static_cast<size_t>(2 * e + 1) * m, Number(0.0));
    for (int j = 0; j + 1 < m; ++j) steps.push_back(Kind::difference(at[j + 1], at[j]));
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

  // f_{j+1,k} - f_jk for all k.
  Field<Kind> row_steps(int j, const Field<Kind>& f) const {
    const int m = v_.size();
    const Number* at = &f[static_cast<size_t>(j) * m];
    Field<Kind> steps;
    for (int k = 0; k < m; ++k) steps.push_back(Kind::difference(at[k + m], at[k]));
    return steps;
  }

  // T_i = sum over k of fx_k Dy(k, i) - fy_k Dx(k, i).
  Field<Kind> meet(const Field<Kind>& fx, const Field<Kind>& fy, const Field<Kind>& dx,
                   const Field<Kind>& dy) const {
    const int m = v_.size(), e = v_.degree();
    Field<Kind> sums(static_cast<size_t>(m), Number(0.0));
    for (int o = 0; o <= 2 * e; ++o) {
      const int from = std::max(0, e - o), to = std::min(m, m + e - o);
      for (int i = from; i < to; ++i) {
        const auto at = static_cast<size_t>(o * m + i), k = static_cast<size_t>(i + o - e);
        sums[static_cast<size_t>(i)] += Kind::minor(fx[k], dy[at], fy[k], dx[at]);
      }
    }
    return sums;
  }

  BasicTauTensor<Number> u_, v_;
};

// One coordinate of the poles.
template <typename Kind>
Field<Kind> coordinate(const Patch& patch, const std::vector<Vec3>& points, int axis) {
  Field<Kind> field;
  for (int id : patch.points) field.push_back(points[static_cast<size_t>(id)][axis]);
  return field;
}

// How far one coordinate of the poles moves.
template <typename Kind>
Field<Kind> movement(const Patch& patch, const std::vector<Vec3>& before,
                     const std::vector<Vec3>& after, int axis) {
  Field<Kind> field;
  for (int id : patch.points) {
    const auto at = static_cast<size_t>(id);
    const typename Kind::Number from(before[at][axis]), to(after[at][axis]);
    field.push_back(to - from);
  }
  return field;
}

DoubleDouble inner_product(const Field<Values>& a, const Field<Values>& b) {
  DoubleDouble sum;
  for (size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

// Rounded up: all terms are non-negative, of a few thousand roundings each at most, and one for
// every term.
double inner_size(const Field<Sizes>& a, const Field<Sizes>& b) {
  double sum = 0.0;
  for (size_t k = 0; k < a.size(); ++k) sum += std::abs(a[k]) * b[k];
  return sum * (1.001 + 4.0 * kUnitRoundoff * static_cast<double>(a.size()));
}

// The change of the integral of z dx dy, expanded so that every term has a movement as a factor:
// dz a(x', y') + z (a(dx, y') + a(x, dy)), with ' for what is after. No large volumes cancel.
template <typename Kind, typename Product>
typename Kind::Number expanded_change(const Patch& patch, const std::vector<Vec3>& before,
                                      const std::vector<Vec3>& after, const Product& product) {
  const Areas<Kind> areas(patch);
  const Field<Kind> y_after = coordinate<Kind>(patch, after, 1);
  const Field<Kind> z = coordinate<Kind>(patch, before, 2);
  typename Kind::Number sum = product(movement<Kind>(patch, before, after, 2),
                                      areas(coordinate<Kind>(patch, after, 0), y_after));
  sum += product(z, areas(movement<Kind>(patch, before, after, 0), y_after));
  sum += product(
      z, areas(coordinate<Kind>(patch, before, 0), movement<Kind>(patch, before, after, 1)));
  return sum;
}

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

// |computed - exact| <= this times the same sum over sizes.
double precise_factor(const Patch& patch) {
  return (kPreciseSteps + static_cast<double>(patch.points.size())) * DoubleDouble::kUnit;
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
  Field<Sizes> heights = coordinate<Sizes>(patch, points, 2);
  for (double& z : heights) z -= height;
  return inner_size(heights, Areas<Sizes>(patch)(coordinate<Sizes>(patch, points, 0),
                                                 coordinate<Sizes>(patch, points, 1)));
}

PreciseNumber precise_flux(const Patch& patch, const std::vector<Vec3>& points) {
  require_polynomial(patch);
  const DoubleDouble sum =
      inner_product(coordinate<Values>(patch, points, 2),
                    Areas<Values>(patch)(coordinate<Values>(patch, points, 0),
                                         coordinate<Values>(patch, points, 1)));
  return {patch.reversed ? -sum : sum,
          precise_factor(patch) * contraction_majorant(patch, points, 0.0)};
}

PreciseNumber precise_flux_change(const Patch& patch, const std::vector<Vec3>& before,
                                  const std::vector<Vec3>& after) {
  ISOCHOR_REQUIRE(before.size() == after.size(), before.size(), after.size());
  require_polynomial(patch);
  const Patch part = touched_part(patch, before, after);
  if (part.points.empty()) return {};
  const DoubleDouble sum = expanded_change<Values>(part, before, after, inner_product);
  const double size = expanded_change<Sizes>(part, before, after, inner_size);
  return {patch.reversed ? -sum : sum, precise_factor(part) * size};
}

std::vector<std::array<DoubleDouble, 3>> precise_areas(const Patch& patch,
                                                       const std::vector<Vec3>& points) {
  require_polynomial(patch);
  const Areas<Values> areas(patch);
  std::vector<std::array<DoubleDouble, 3>> rows(patch.points.size());
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto column = areas(coordinate<Values>(patch, points, static_cast<int>((axis + 1) % 3)),
                              coordinate<Values>(patch, points, static_cast<int>((axis + 2) % 3)));
    for (size_t k = 0; k < rows.size(); ++k) {
      rows[k][axis] = patch.reversed ? -column[k] : column[k];
    }
  }
  return rows;
}

}  // namespace isochor
