#include "isochor/volume/gauss.h"

#include <cmath>

#include "isochor/base/error.h"

namespace isochor {
namespace {

// P_n(1 - y) and its derivative with respect to y, for small y without cancellation in 1 - y:
// the recursion is run on the differences P_k - P_{k-1}.
struct Legendre {
  long double value;
  long double slope;
};

Legendre legendre_near_one(int n, long double y) {
  // (k + 1)(P_{k+1} - P_k) = k (P_k - P_{k-1}) - (2k + 1) y P_k.
  long double p = 1.0L;
  long double difference = 0.0L;
  long double dp = 0.0L;
  long double d_difference = 0.0L;
  for (int k = 0; k < n; ++k) {
    const long double next = (k * difference - (2 * k + 1) * y * p) / (k + 1);
    const long double d_next = (k * d_difference - (2 * k + 1) * (p + y * dp)) / (k + 1);
    difference = next;
    d_difference = d_next;
    p += difference;
    dp += d_difference;
  }
  return {p, dp};
}

std::vector<double> rounded(const std::vector<long double>& numbers) {
  std::vector<double> result;
  result.reserve(numbers.size());
  for (long double x : numbers) result.push_back(static_cast<double>(x));
  return result;
}

}  // namespace

GaussRule gauss_legendre(int count) {
  const LongGaussRule rule = long_gauss_legendre(count);
  return {rounded(rule.nodes), rounded(rule.from_end), rounded(rule.weights)};
}

LongGaussRule long_gauss_legendre(int count) {
  ISOCHOR_REQUIRE(1 <= count && count <= kMaxGaussPoints, count);
  const auto size = static_cast<size_t>(count);
  LongGaussRule rule;
  rule.nodes.resize(size);
  rule.from_end.resize(size);
  rule.weights.resize(size);
  const long double pi = std::acos(-1.0L);
  for (size_t i = 0; i < (size + 1) / 2; ++i) {
    // The i-th root from the right is x = 1 - y; Newton from the classical estimate cos(theta).
    const long double theta = pi * (static_cast<long double>(i) + 0.75L) / (count + 0.5L);
    const long double half_sine = std::sin(theta / 2);
    long double y = 2 * half_sine * half_sine;
    for (int step = 0; step < 8; ++step) {
      const Legendre at = legendre_near_one(count, y);
      y -= at.value / at.slope;
    }
    if (2 * i + 1 == size) y = 1.0L;
    const long double slope = legendre_near_one(count, y).slope;
    const long double small = y / 2;
    const long double large = 1.0L - y / 2;
    const long double weight = 1.0L / (y * (2 - y) * slope * slope);
    const size_t mirror = size - 1 - i;
    rule.nodes[i] = rule.from_end[mirror] = small;
    rule.from_end[i] = rule.nodes[mirror] = large;
    rule.weights[i] = rule.weights[mirror] = weight;
  }
  return rule;
}

}  // namespace isochor
