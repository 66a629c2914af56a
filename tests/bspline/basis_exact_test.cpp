// The basis against rational arithmetic: every kind of knot vector, every degree.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "isochor/base/error.h"
#include "isochor/bspline/basis.h"
#include "support/exact_splines.h"
#include "support/messages.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::all_small_knots;
using ::isochor::testing::exact_basis;
using ::isochor::testing::message_of;
using ::isochor::testing::roundoffs;
using ::testing::HasSubstr;

// Roundings of one value: five for each degree of the recursion (two differences, a quotient, a
// product, a sum), and as many for each derivative.
double allowed(int degree) { return 6.0 * degree + 1.0; }

void expect_exact(const KnotVector& knots, int span, double u, int order) {
  const BasisValues b = evaluate_basis_on_span(knots, span, u, order);
  ASSERT_EQ(b.first, span - knots.degree());
  ASSERT_EQ(b.degree, knots.degree());
  for (int r = 0; r <= order; ++r) {
    const auto exact = exact_basis(knots, span, Rational(u), r);
    const auto sizes = exact_basis(knots, span, Rational(u), r, true);
    for (int j = 0; j <= b.degree; ++j) {
      const auto k = static_cast<size_t>(j);
      if (sizes[k].is_zero()) {
        EXPECT_EQ(b.value(r, j), 0.0);
      } else {
        EXPECT_LE(roundoffs(b.value(r, j), exact[k], sizes[k]), allowed(b.degree))
            << "degree " << b.degree << " span " << span << " at " << u << " order " << r;
      }
    }
  }
}

// The same knots with few digits, so that exact arithmetic of high degrees stays fast.
KnotVector on_a_grid(const KnotVector& knots) {
  std::vector<double> rounded = knots.knots();
  for (double& t : rounded) t = std::round(64.0 * t) / 64.0;
  return KnotVector(knots.degree(), rounded);
}

TEST(BasisExact, ValuesAndDerivativesOfAllDegrees) {
  std::mt19937 random(301);
  for (int degree = 1; degree <= kMaxDegree; degree += degree < 13 ? 1 : 2) {
    for (const KnotVector& random_knots :
         {testing::random_clamped(random, degree, 2), testing::random_unclamped(random, degree, 2),
          testing::random_wrapped(random, degree, 3)}) {
      const KnotVector knots = degree < 5 ? random_knots : on_a_grid(random_knots);
      for (int span : knots.spans()) {
        const double share = std::round(64.0 * testing::uniform(random, 0.0, 1.0)) / 64.0;
        expect_exact(knots, span, knots[span] + share * (knots[span + 1] - knots[span]),
                     degree < 10 ? 3 : 1);
      }
    }
  }
}

TEST(BasisExact, BothLimitsAtEveryKnotOfAllSmallVectors) {
  for (int degree : {1, 2, 3}) {
    for (const KnotVector& knots : all_small_knots(degree, 2 * degree + 3)) {
      for (int span : knots.spans()) {
        expect_exact(knots, span, knots[span], 3);
        expect_exact(knots, span, knots[span + 1], 3);
      }
    }
  }
}

TEST(BasisExact, KnotsFarFromZeroAndOfVeryDifferentLengths) {
  const std::vector<KnotVector> vectors = {
      KnotVector::clamped(3, {1e6, 1e6 + 0.5, 1e6 + 0.5, 1e6 + 3.0}),
      KnotVector::clamped(4, {-1e9, -1e9 + 1.0, -1e9 + 2.0}),
      KnotVector::clamped(3, {0.0, 1e-12, 1.0, 1e9}), KnotVector::clamped(2, {1e-300, 2e-300, 1.0}),
      KnotVector(5, {0, 1e-9, 2e-9, 1, 2, 3, 3, 3, 3, 3, 4, 5e8, 6e8, 7e8, 8e8, 9e8})};
  for (const KnotVector& knots : vectors) {
    for (int span : knots.spans()) {
      for (double share : {0.0, 0.3, 0.999, 1.0}) {
        expect_exact(knots, span, knots[span] + share * (knots[span + 1] - knots[span]), 0);
      }
    }
  }
}

TEST(BasisExact, ContinuedBeyondTheDomainTheEndSpansGoOn) {
  std::mt19937 random(302);
  for (int degree : {1, 3, 6}) {
    const KnotVector knots = testing::random_clamped(random, degree, 3, 1);
    for (double u : {knots.begin() - 0.75, knots.end() + 0.5}) {
      const BasisValues b = evaluate_basis(knots, u, 1);
      const int span = u < knots.begin() ? knots.spans().front() : knots.spans().back();
      EXPECT_EQ(b.first, span - degree);
      const auto exact = exact_basis(knots, span, Rational(u), 1);
      const auto sizes = exact_basis(knots, span, Rational(u), 1, true);
      for (int j = 0; j <= degree; ++j) {
        const auto k = static_cast<size_t>(j);
        if (sizes[k].is_zero()) continue;
        EXPECT_LE(roundoffs(b.value(1, j), exact[k], sizes[k]), allowed(degree));
      }
    }
  }
}

TEST(BasisExact, SupportIsLocalAndValuesAreNotNegative) {
  for (int degree : {1, 2, 3}) {
    for (const KnotVector& knots : all_small_knots(degree, 2 * degree + 4)) {
      for (double u = knots.begin(); u <= knots.end(); u += 0.25) {
        const BasisValues b = evaluate_basis(knots, u);
        double sum = 0.0;
        for (int j = 0; j <= degree; ++j) {
          const int i = b.first + j;
          const double value = b.value(0, j);
          sum += value;
          EXPECT_GE(value, 0.0);
          if (u < knots[i] || u > knots[i + degree + 1]) {
            EXPECT_EQ(value, 0.0) << i << ' ' << u;
          }
          // Strictly inside its support a function is positive.
          if (knots[i] < u && u < knots[i + degree + 1]) {
            EXPECT_GT(value, 0.0) << ::testing::PrintToString(knots.knots()) << ' ' << u;
          }
        }
        EXPECT_NEAR(sum, 1.0, 1e-15);
      }
    }
  }
}

TEST(BasisExact, RightContinuousInsideAndClosedAtTheEnd) {
  // A knot as often as the degree: the value is continuous, the slope jumps, and a plain evaluation
  // takes the span that begins there.
  const KnotVector knots(2, {0, 0, 0, 1, 1, 3, 3, 3});
  const BasisValues at = evaluate_basis(knots, 1.0, 1);
  EXPECT_EQ(at.first, 2);
  EXPECT_EQ(at.value(0, 0), 1.0);
  EXPECT_EQ(at.value(1, 0), -1.0);
  EXPECT_EQ(at.value(1, 1), 1.0);
  const BasisValues below = evaluate_basis_on_span(knots, 2, 1.0, 1);
  EXPECT_EQ(below.first, 0);
  EXPECT_EQ(below.value(0, 2), 1.0);
  EXPECT_EQ(below.value(1, 2), 2.0);
  EXPECT_EQ(below.value(1, 1), -2.0);
  // At the end of the domain the last span is closed, also when the knots go on.
  EXPECT_EQ(evaluate_basis(knots, 3.0).first, 2);
  const KnotVector open(1, {0, 1, 2, 3, 4});
  EXPECT_EQ(evaluate_basis(open, 3.0).first, 1);
  EXPECT_EQ(evaluate_basis(open, 3.0).value(0, 1), 1.0);
}

TEST(BasisExact, DerivativesBeyondTheDegreeAreZero) {
  const KnotVector knots = KnotVector::uniform(1, 2);
  const BasisValues b = evaluate_basis(knots, 0.25, 3);
  EXPECT_EQ(b.value(1, 0), -2.0);
  EXPECT_EQ(b.value(1, 1), 2.0);
  for (int r : {2, 3}) {
    for (int j : {0, 1}) EXPECT_EQ(b.value(r, j), 0.0);
  }
}

TEST(BasisExact, OrdersAndSpansOutOfRangeAreTheCallersBug) {
  const KnotVector knots(2, {0, 0, 0, 1, 1, 2, 2, 2});
  EXPECT_THROW(evaluate_basis(knots, 0.5, -1), PreconditionError);
  EXPECT_THAT(message_of<PreconditionError>([&] { evaluate_basis(knots, 0.5, 4); }),
              HasSubstr("order"));
  EXPECT_THROW(evaluate_basis_on_span(knots, 1, 0.5), PreconditionError);
  EXPECT_THROW(evaluate_basis_on_span(knots, 5, 0.5), PreconditionError);
  // The empty span between the two copies of 1: 0/0, not an answer.
  EXPECT_THAT(message_of<PreconditionError>([&] { evaluate_basis_on_span(knots, 3, 1.0); }),
              HasSubstr("knots[span] < knots[span + 1]"));
}

TEST(BasisExact, NotANumberIsNotHidden) {
  const BasisValues b = evaluate_basis(KnotVector::uniform(3, 2), std::nan(""));
  for (int j = 0; j <= 3; ++j) EXPECT_TRUE(std::isnan(b.value(0, j)));
}

}  // namespace
}  // namespace isochor
