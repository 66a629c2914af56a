#include "isochor/bspline/line_strips.h"

#include <gtest/gtest.h>

#include <cmath>

#include "isochor/bspline/exact_refinement.h"

namespace isochor::internal {
namespace {

TEST(KnownFactors, AreFoundWithinTheNoiseAndInTheOrderAdded) {
  KnownFactors known;
  known.add(Rational(2));
  known.add(Rational::parse("3/2"));
  known.add(Rational(2));
  EXPECT_EQ(known.size(), 2u);
  ASSERT_NE(known.find(1.75, 0.5), nullptr);
  EXPECT_EQ(*known.find(1.75, 0.5), Rational(2));
  EXPECT_EQ(*known.find(1.6, 0.2), Rational::parse("3/2"));
  EXPECT_EQ(known.find(1.0, 0.25), nullptr);
  known.shrink_to(1);
  EXPECT_EQ(known.find(1.6, 0.2), nullptr);
}

TEST(KnownFactors, EndsAreExactWhereDoublesCannotTellThemApart) {
  // All of these round to 1.
  const double noise = std::ldexp(1.0, -60);
  const Rational inside = Rational(1) + Rational(std::ldexp(1.0, -61));
  const Rational outside = Rational(1) + Rational(std::ldexp(1.0, -59));
  KnownFactors known;
  known.add(outside);
  EXPECT_EQ(known.find(1.0, noise), nullptr);
  known.add(inside);
  ASSERT_NE(known.find(1.0, noise), nullptr);
  EXPECT_EQ(*known.find(1.0, noise), inside);
  KnownFactors end;
  end.add(Rational(1) + Rational(noise));
  EXPECT_NE(end.find(1.0, noise), nullptr);
}

TEST(KnownShares, AreThoseOfTheirKnotsAndComputedOnce) {
  const auto knots = KnotVector::clamped(3, {0.0, 0.1, 0.2, 0.7, 1.0});
  KnownShares known;
  for (int span : knots.spans()) {
    const double end = knots[span + 1];
    for (bool backwards : {false, true}) {
      const auto shares = known.at(knots, span, end, backwards);
      for (int r = 0; r < 3; ++r) {
        const auto exact = exact_derivatives(knots, span, end, r);
        for (size_t i = 0; i < exact.size(); ++i) {
          const Rational expected = backwards && r == 1 ? -exact[i] : exact[i];
          EXPECT_EQ(shares->derivatives[static_cast<size_t>(r)][i], expected);
          EXPECT_EQ(shares->rounded[static_cast<size_t>(r)][i], expected.to_double());
        }
      }
    }
  }
  // Another vector with the same knots near the second span, and one with others.
  const auto like = KnotVector(3, {0, 0, 0, 0, 0.1, 0.2, 0.7, 1, 1, 1, 1.5, 2, 2, 2, 2});
  const auto unlike = KnotVector::clamped(3, {0.0, 0.1, 0.25, 0.7, 1.0});
  EXPECT_EQ(known.at(like, 4, 0.2, false), known.at(knots, 4, 0.2, false));
  EXPECT_NE(known.at(unlike, 4, 0.25, false), known.at(knots, 4, 0.2, false));
  EXPECT_NE(known.at(knots, 4, 0.1, false), known.at(knots, 4, 0.2, false));
  EXPECT_NE(known.at(knots, 4, 0.2, true), known.at(knots, 4, 0.2, false));
}

}  // namespace
}  // namespace isochor::internal
