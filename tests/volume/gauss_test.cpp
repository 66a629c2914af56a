#include "isochor/volume/gauss.h"

#include <gtest/gtest.h>

#include <cmath>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/volume/span_table.h"

namespace isochor {
namespace {

TEST(Gauss, ExactnessUpToDegreeTwiceTheCountMinusOne) {
  for (int n = 1; n <= kMaxGaussPoints; ++n) {
    const GaussRule rule = gauss_legendre(n);
    for (int power = 0; power <= 2 * n - 1; ++power) {
      double moment = 0.0;
      for (size_t i = 0; i < rule.nodes.size(); ++i) {
        moment += rule.weights[i] * std::pow(rule.nodes[i], power);
      }
      const double exact = 1.0 / (power + 1);
      EXPECT_NEAR(moment, exact, (4 + 2 * power) * kUnitRoundoff * exact) << n << ' ' << power;
    }
  }
}

TEST(Gauss, OneDegreeMoreIsNotExact) {
  const GaussRule rule = gauss_legendre(3);
  double moment = 0.0;
  for (size_t i = 0; i < 3; ++i) moment += rule.weights[i] * std::pow(rule.nodes[i], 6);
  EXPECT_GT(std::abs(moment - 1.0 / 7), 1e-5);
}

TEST(Gauss, KnownRules) {
  const GaussRule two = gauss_legendre(2);
  EXPECT_DOUBLE_EQ(two.nodes[0], 0.5 - std::sqrt(1.0 / 12));
  EXPECT_DOUBLE_EQ(two.weights[0], 0.5);
  const GaussRule three = gauss_legendre(3);
  EXPECT_DOUBLE_EQ(three.nodes[1], 0.5);
  EXPECT_DOUBLE_EQ(three.weights[1], 4.0 / 9);
  EXPECT_DOUBLE_EQ(three.nodes[2], 0.5 + std::sqrt(0.15));
}

TEST(Gauss, NodesAscendAndMirror) {
  const GaussRule rule = gauss_legendre(64);
  for (size_t i = 0; i < 64; ++i) {
    EXPECT_DOUBLE_EQ(rule.nodes[i] + rule.from_end[i], 1.0);
    EXPECT_EQ(rule.nodes[i], rule.from_end[63 - i]);
    EXPECT_EQ(rule.weights[i], rule.weights[63 - i]);
    if (i > 0) {
      EXPECT_LT(rule.nodes[i - 1], rule.nodes[i]);
    }
  }
}

TEST(Gauss, RefusesCountsOutsideItsRange) {
  EXPECT_THROW(gauss_legendre(0), PreconditionError);
  EXPECT_THROW(gauss_legendre(kMaxGaussPoints + 1), PreconditionError);
}

}  // namespace
}  // namespace isochor
