// Gauss-Legendre rules on [0, 1].
//
// Law (1) exactness: the n-point rule integrates polynomials of degree 2n - 1 up to rounding.
#pragma once

#include <vector>

namespace isochor {

inline constexpr int kMaxGaussPoints = 64;

// The numbers of a rule (see GaussRule) before they are rounded to double: each is within
// kLongGaussUnits unit roundoffs of long double, relatively (tests hold them against fifty digits).
struct LongGaussRule {
  std::vector<long double> nodes;
  std::vector<long double> from_end;
  std::vector<long double> weights;
};
inline constexpr double kLongGaussUnits = 32.0;
LongGaussRule long_gauss_legendre(int count);

// Nodes ascending in (0, 1). `from_end[i]` is 1 - nodes[i], computed without cancellation, so that
// both distances carry full relative accuracy; the weights are positive and sum to 1.
struct GaussRule {
  std::vector<double> nodes;
  std::vector<double> from_end;
  std::vector<double> weights;
};

// The rule with `count` points, 1 <= count <= kMaxGaussPoints; cost O(count^2).
// Error: each number is within two units in its last place (checked against symmetric function
// identities and moments in tests/volume/gauss_test.cpp).
GaussRule gauss_legendre(int count);

}  // namespace isochor
