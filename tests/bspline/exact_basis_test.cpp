#include "isochor/bspline/exact_basis.h"

#include <gtest/gtest.h>

#include "isochor/bspline/basis.h"
#include "support/exact_splines.h"
#include "support/splines.h"

namespace isochor {
namespace {

TEST(ExactBasis, EqualsTheOracleAndRoundsToTheBasis) {
  std::mt19937 random(311);
  for (int degree = 1; degree <= 7; ++degree) {
    for (const KnotVector& knots :
         {testing::random_clamped(random, degree, 3), testing::random_unclamped(random, degree, 3),
          testing::random_wrapped(random, degree, 4)}) {
      std::vector<double> parameters = knots.breaks();
      for (int k = 0; k < 3; ++k) {
        parameters.push_back(testing::uniform(random, knots.begin(), knots.end()));
      }
      for (double u : parameters) {
        const int span = knots.span_of(u);
        const ExactBasisValues exact = evaluate_exact_basis(knots, u);
        const BasisValues rounded = evaluate_basis(knots, u, 1);
        const auto values = testing::exact_basis(knots, span, Rational(u), 0);
        const auto slopes = testing::exact_basis(knots, span, Rational(u), 1);
        ASSERT_EQ(exact.first, span - degree);
        ASSERT_EQ(exact.first, rounded.first);
        Rational sum, slope_sum;
        for (int j = 0; j <= degree; ++j) {
          const auto at = static_cast<size_t>(j);
          EXPECT_EQ(exact.values[at], values[at]);
          EXPECT_EQ(exact.slopes[at], slopes[at]);
          EXPECT_NEAR(exact.values[at].to_double(), rounded.value(0, j), 1e-14);
          sum += exact.values[at];
          slope_sum += exact.slopes[at];
        }
        EXPECT_EQ(sum, Rational(1));
        EXPECT_TRUE(slope_sum.is_zero());
      }
    }
  }
}

}  // namespace
}  // namespace isochor
