#include "isochor/volume/gauss_remainder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "isochor/base/tolerance.h"
#include "isochor/volume/span_table.h"

namespace isochor::internal {
namespace {

// Bernstein coefficient `i` on a span: the blossom at d - i copies of its begin and i of its end.
// `c` holds the d + 1 coefficients of the span's functions and is overwritten.
double bernstein_coefficient(const KnotVector& knots, int span, int i, std::vector<double>& c) {
  const int d = knots.degree();
  for (int r = 1; r <= d; ++r) {
    const bool at_begin = r <= d - i;
    for (int j = d; j >= r; --j) {
      const double left = knots[span - d + j];
      const double right = knots[span + 1 + j - r];
      // Both shares are quotients of non-negative differences: nothing cancels.
      const double ahead = right - (at_begin ? knots[span] : knots[span + 1]);
      const double behind = (at_begin ? knots[span] : knots[span + 1]) - left;
      const auto ji = static_cast<size_t>(j);
      c[ji] = (ahead * c[ji - 1] + behind * c[ji]) / (right - left);
    }
  }
  return c[static_cast<size_t>(d)];
}

// What the bound needs of a net; every number is relative to the mean of its column.
struct NetSizes {
  // Per column: |Chebyshev coefficients| 1 .. d, divided by the mean.
  std::vector<std::vector<double>> waves;
  double top = 0.0;             // largest weight
  double slope_t = 0.0;         // d (w_i + w_{i+1})
  double slope_s = 0.0;         // e (w_j + w_{j+1})
  double weight_slope_t = 0.0;  // d |w_{i+1} - w_i|
  double weight_slope_s = 0.0;
};

// The relative error of a net that came from net_of and at most kMaxHalvings halvings.
double noise_of(const WeightNet& net) {
  return (8.0 + kMaxHalvings) * (net.rows + net.columns) * kUnitRoundoff;
}

// The Chebyshev points of [0, 1] and T_k at each of them.
struct ChebyshevPoints {
  explicit ChebyshevPoints(int points) : count(points) {
    const double pi = std::acos(-1.0);
    for (int g = 0; g < count; ++g) {
      const double angle = pi * (g + 0.5) / count;
      at.push_back(std::pow(std::cos(angle / 2), 2));
      from_end.push_back(std::pow(std::sin(angle / 2), 2));
      for (int k = 0; k < count; ++k) waves.push_back(std::cos(k * angle));
    }
  }
  int count;
  std::vector<double> at, from_end, waves;
};

// |Chebyshev coefficients| of W(., s_j), enlarged by their rounding (the first, reduced): the
// discrete cosine sum over d + 1 points, each value a sum of positive terms.
std::vector<double> chebyshev_sizes(const WeightNet& net, int j, const ChebyshevPoints& points) {
  const auto count = static_cast<size_t>(points.count);
  std::vector<double> sizes(count, 0.0);
  std::vector<double> c(count);
  double top = 0.0;
  for (size_t g = 0; g < count; ++g) {
    for (size_t i = 0; i < count; ++i) c[i] = net(static_cast<int>(i), j);
    for (size_t r = count - 1; r > 0; --r) {
      for (size_t i = 0; i < r; ++i) c[i] = points.from_end[g] * c[i] + points.at[g] * c[i + 1];
    }
    for (size_t k = 0; k < count; ++k) sizes[k] += c[0] * points.waves[g * count + k];
    top = std::max(top, c[0]);
  }
  const double scale = 1.0 / points.count;
  const double rounding = 2.0 * (noise_of(net) + 16.0 * (points.count + 1) * kUnitRoundoff) * top;
  sizes[0] = sizes[0] * scale - rounding;
  for (size_t k = 1; k < count; ++k) sizes[k] = 2.0 * std::abs(sizes[k]) * scale + rounding;
  return sizes;
}

NetSizes sizes_of(const WeightNet& net) {
  NetSizes sizes;
  const int d = net.rows - 1;
  const int e = net.columns - 1;
  const double noise = noise_of(net);
  const auto step = [&](double a, double b) { return std::abs(a - b) + noise * (a + b); };
  const ChebyshevPoints points(net.rows);
  std::vector<double> means;
  std::vector<double> tops;
  for (int j = 0; j <= e; ++j) {
    std::vector<double> waves = chebyshev_sizes(net, j, points);
    const double mean = waves[0];
    waves.erase(waves.begin());
    for (double& wave : waves) wave /= mean;
    sizes.waves.push_back(std::move(waves));
    means.push_back(mean);
    double top = net(d, j);
    for (int i = 0; i < d; ++i) {
      top = std::max(top, net(i, j));
      sizes.slope_t = std::max(sizes.slope_t, d * (net(i, j) + net(i + 1, j)) / mean);
      sizes.weight_slope_t =
          std::max(sizes.weight_slope_t, d * step(net(i + 1, j), net(i, j)) / mean);
    }
    tops.push_back(top);
    sizes.top = std::max(sizes.top, top / mean);
  }
  for (size_t j = 0; j + 1 < means.size(); ++j) {
    const double mean = std::min(means[j], means[j + 1]);
    sizes.slope_s = std::max(sizes.slope_s, e * (tops[j] + tops[j + 1]) / mean);
    for (int i = 0; i <= d; ++i) {
      const int column = static_cast<int>(j);
      const double across = step(net(i, column), net(i, column + 1));
      sizes.weight_slope_s = std::max(sizes.weight_slope_s, e * across / mean);
    }
  }
  return sizes;
}

// The largest share by which W leaves its mean on the ellipse, over all columns.
double drift(const NetSizes& sizes, double log_rho) {
  std::vector<double> growth(sizes.waves[0].size());
  for (size_t k = 0; k < growth.size(); ++k) {
    growth[k] = std::cosh(static_cast<double>(k + 1) * log_rho);
  }
  double most = 0.0;
  for (const std::vector<double>& waves : sizes.waves) {
    most = std::max(most, std::inner_product(waves.begin(), waves.end(), growth.begin(), 0.0));
  }
  return most;
}

// Sizes of numerators and denominator over |W|.
struct Quotients {
  double position, slope_t, slope_s, weight_slope_t, weight_slope_s;
};

// z times the determinant over W^3, or x y_t.
double size_of(const Quotients& q, Integrand integrand) {
  if (integrand == Integrand::kArea) {
    return q.position * (q.slope_t + q.position * q.weight_slope_t);
  }
  return 2.0 * q.position *
         (q.position * (q.slope_t * q.weight_slope_s + q.slope_s * q.weight_slope_t) +
          q.slope_t * q.slope_s);
}

// For real t: sums and differences of neighbours over the smaller one.
Quotients quotients_on_the_cell(const WeightNet& net) {
  const double noise = noise_of(net);
  double slope_t = 0.0;
  double slope_s = 0.0;
  double weight_slope_t = 0.0;
  double weight_slope_s = 0.0;
  const auto see = [&](double a, double b, double& slope, double& weight_slope) {
    slope = std::max(slope, (a + b) / std::min(a, b));
    weight_slope = std::max(weight_slope, (std::abs(a - b) + noise * (a + b)) / std::min(a, b));
  };
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      if (i + 1 < net.rows) see(net(i, j), net(i + 1, j), slope_t, weight_slope_t);
      if (j + 1 < net.columns) see(net(i, j), net(i, j + 1), slope_s, weight_slope_s);
    }
  }
  const double d = net.rows - 1;
  const double e = net.columns - 1;
  return {1.0, d * slope_t, e * slope_s, d * weight_slope_t, e * weight_slope_s};
}

// Rounding of the bound itself.
constexpr double kSafety = 1.0 + 1e-9;
// The ellipses tried, up to the one where the proof that W has no zero ends.
constexpr int kEllipses = 24;
constexpr double kMaxLogRho = 16.0;

}  // namespace

WeightNet net_of(const KnotVector& u, const KnotVector& v, const std::vector<double>& weights,
                 int su, int sv) {
  WeightNet net;
  net.rows = u.degree() + 1;
  net.columns = v.degree() + 1;
  const int u_span = u.spans()[static_cast<size_t>(su)];
  const int v_span = v.spans()[static_cast<size_t>(sv)];
  const auto weight = [&](int i, int j) {
    return weights[static_cast<size_t>(u_span - u.degree() + i) * static_cast<size_t>(v.size()) +
                   static_cast<size_t>(v_span - v.degree() + j)];
  };
  net.equal_rows = net.equal_columns = true;
  WeightNet half = net;  // Bernstein along v, B-spline along u
  std::vector<double> c;
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      net.equal_rows = net.equal_rows && weight(i, j) == weight(0, j);
      net.equal_columns = net.equal_columns && weight(i, j) == weight(i, 0);
      c.resize(static_cast<size_t>(net.columns));
      for (int k = 0; k < net.columns; ++k) c[static_cast<size_t>(k)] = weight(i, k);
      half.at.push_back(bernstein_coefficient(v, v_span, j, c));
    }
  }
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      c.resize(static_cast<size_t>(net.rows));
      for (int k = 0; k < net.rows; ++k) c[static_cast<size_t>(k)] = half(k, j);
      net.at.push_back(bernstein_coefficient(u, u_span, i, c));
    }
  }
  return net;
}

WeightNet net_of(const KnotVector& knots, const std::vector<double>& weights, int s) {
  WeightNet net;
  net.rows = knots.degree() + 1;
  net.columns = 1;
  net.equal_columns = true;
  const int span = knots.spans()[static_cast<size_t>(s)];
  const auto first = weights.begin() + (span - knots.degree());
  net.equal_rows = std::all_of(first, first + net.rows, [&](double w) { return w == *first; });
  for (int i = 0; i < net.rows; ++i) {
    std::vector<double> c(first, first + net.rows);
    net.at.push_back(bernstein_coefficient(knots, span, i, c));
  }
  return net;
}

WeightNet transposed(const WeightNet& net) {
  WeightNet result;
  result.rows = net.columns;
  result.columns = net.rows;
  result.equal_rows = net.equal_columns;
  result.equal_columns = net.equal_rows;
  for (int j = 0; j < net.columns; ++j) {
    for (int i = 0; i < net.rows; ++i) result.at.push_back(net(i, j));
  }
  return result;
}

std::pair<WeightNet, WeightNet> halves(const WeightNet& net) {
  WeightNet left = net;
  WeightNet right = net;
  const auto columns = static_cast<size_t>(net.columns);
  // After step r, row i of `right` is the i-th of the r-th row of de Casteljau's triangle.
  for (int r = 1; r < net.rows; ++r) {
    for (int i = 0; i + r < net.rows; ++i) {
      const size_t row = static_cast<size_t>(i) * columns;
      for (size_t k = row; k < row + columns; ++k) {
        right.at[k] = 0.5 * (right.at[k] + right.at[k + columns]);
      }
    }
    std::copy_n(right.at.begin(), columns,
                left.at.begin() + static_cast<std::ptrdiff_t>(static_cast<size_t>(r) * columns));
  }
  return {std::move(left), std::move(right)};
}

WeightNet part_of(const WeightNet& net, double begin, double end) {
  if (begin == 0.0 && end == 1.0) return net;
  auto [left, right] = halves(net);
  return end <= 0.5 ? part_of(left, 2.0 * begin, 2.0 * end)
                    : part_of(right, 2.0 * begin - 1.0, 2.0 * end - 1.0);
}

GaussRemainder::GaussRemainder(const WeightNet& net, Integrand integrand) {
  on_the_cell_ = kSafety * 2.0 * size_of(quotients_on_the_cell(net), integrand);
  if (net.equal_rows) {
    exact_points_ = exact_gauss_points(net.rows - 1);
    return;
  }
  const NetSizes sizes = sizes_of(net);
  // The largest ellipse on which W provably has no zero.
  double low = 0.0;
  double high = kMaxLogRho;
  if (drift(sizes, high) < 1.0) low = high;
  for (int step = 0; step < 24 && low < high; ++step) {
    const double middle = 0.5 * (low + high);
    (drift(sizes, middle) < 1.0 ? low : high) = middle;
  }
  const double d = net.rows - 1;
  for (int k = 1; k < kEllipses && low > 0.0; ++k) {
    const double log_rho = low * k / kEllipses;
    const double left = 1.0 - drift(sizes, log_rho);
    if (!(left > 0.0)) break;
    const double a = std::cosh(log_rho);
    const double power = std::pow(a, d - 1) / left;
    const Quotients quotients = {sizes.top * a * power, sizes.slope_t * power,
                                 sizes.slope_s * a * power, sizes.weight_slope_t * power,
                                 sizes.weight_slope_s * a * power};
    const double size = size_of(quotients, integrand);
    const double factor = kSafety * (32.0 / 15.0) * size / -std::expm1(-2.0 * log_rho);
    if (std::isfinite(factor)) ellipses_.push_back({log_rho, std::log(factor)});
  }
}

double GaussRemainder::bound(int n) const {
  if (n < 2) return std::numeric_limits<double>::infinity();
  if (exact_points_ != 0 && n >= exact_points_) return 0.0;
  double least = on_the_cell_;
  for (const Ellipse& ellipse : ellipses_) {
    least = std::min(least, kSafety * std::exp(ellipse.log_factor - 2.0 * n * ellipse.log_rho));
  }
  return least;
}

int GaussRemainder::points(double tolerance, int least, int most) const {
  if (bound(least) <= tolerance) return least;
  // Each ellipse says where its own bound gets there; `bound` decides about rounding.
  double fewest = most + 1.0;
  if (exact_points_ != 0) fewest = std::min(fewest, static_cast<double>(exact_points_));
  for (const Ellipse& ellipse : ellipses_) {
    const double count = (ellipse.log_factor - std::log(tolerance)) / (2.0 * ellipse.log_rho);
    fewest = std::min(fewest, std::ceil(count));
  }
  for (int n = std::max(least, static_cast<int>(fewest)); n <= most; ++n) {
    if (bound(n) <= tolerance) return n;
  }
  return most + 1;
}

}  // namespace isochor::internal
