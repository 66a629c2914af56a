#include "isochor/bspline/basis.h"

#include <gtest/gtest.h>

#include <random>

namespace isochor {
namespace {

KnotVector random_knots(std::mt19937& random, int degree) {
  std::uniform_real_distribution<double> gap(0.1, 1.0);
  std::uniform_int_distribution<int> repeat(1, degree);
  std::vector<double> knots(static_cast<size_t>(degree) + 1, 0.0);
  double at = 0.0;
  for (int span = 0; span < 4; ++span) {
    at += gap(random);
    knots.insert(knots.end(), static_cast<size_t>(repeat(random)), at);
  }
  at += gap(random);
  knots.insert(knots.end(), static_cast<size_t>(degree) + 1, at);
  return KnotVector(degree, knots);
}

TEST(Basis, PartitionOfUnityAndDerivativesSumToZero) {
  std::mt19937 random(1);
  for (int degree : {1, 2, 3, 5, 13, 25}) {
    const KnotVector knots = random_knots(random, degree);
    for (double s : {0.0, 0.13, 0.5, 0.77, 1.0}) {
      const double u = knots.begin() + s * (knots.end() - knots.begin());
      const BasisValues b = evaluate_basis(knots, u, 2);
      for (int r = 0; r <= 2; ++r) {
        double sum = 0.0;
        double size = 0.0;
        for (int j = 0; j <= degree; ++j) {
          sum += b.value(r, j);
          size += std::abs(b.value(r, j));
        }
        EXPECT_NEAR(sum, r == 0 ? 1.0 : 0.0, 1e-13 * (1.0 + size)) << degree << ' ' << u;
      }
    }
  }
}

TEST(Basis, DerivativesMatchFiniteDifferences) {
  std::mt19937 random(2);
  for (int degree : {2, 3, 4, 7}) {
    const KnotVector knots = random_knots(random, degree);
    for (int span : knots.spans()) {
      const double width = knots[span + 1] - knots[span];
      const double u = knots[span] + 0.41 * width;
      const double h = 1e-5 * width;
      for (int r = 1; r <= 3; ++r) {
        const BasisValues low = evaluate_basis_on_span(knots, span, u - h, r - 1);
        const BasisValues high = evaluate_basis_on_span(knots, span, u + h, r - 1);
        const BasisValues exact = evaluate_basis_on_span(knots, span, u, r);
        double scale = 1.0;
        for (int j = 0; j <= degree; ++j) scale = std::max(scale, std::abs(exact.value(r, j)));
        for (int j = 0; j <= degree; ++j) {
          const double difference = (high.value(r - 1, j) - low.value(r - 1, j)) / (2 * h);
          EXPECT_NEAR(exact.value(r, j), difference, 1e-5 * scale) << degree << ' ' << r;
        }
      }
    }
  }
}

TEST(Basis, EndsInterpolateWhenClamped) {
  const KnotVector knots = KnotVector::uniform(3, 4);
  EXPECT_EQ(evaluate_basis(knots, 0.0).value(0, 0), 1.0);
  EXPECT_EQ(evaluate_basis(knots, 1.0).value(0, 3), 1.0);
  EXPECT_EQ(evaluate_basis(knots, 1.0).first, 3);
}

}  // namespace
}  // namespace isochor
