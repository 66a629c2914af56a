#include "isochor/bspline/exact_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isochor/base/error.h"
#include "isochor/bspline/refinement.h"
#include "support/exact_splines.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::exact_basis;
using ::isochor::testing::exact_insertion;
using ::isochor::testing::roundoffs;

Rational sum_of(const ExactMapRow& row) {
  Rational sum;
  for (const Rational& value : row.coefficients) sum += value;
  return sum;
}

// Against the rounded matrix: the same nonzeros, each within some roundings for each degree.
void expect_rounds_to(const ExactMap& exact, const BandedMap& map, int degree) {
  ASSERT_EQ(static_cast<int>(exact.size()), map.size_fine());
  for (int i = 0; i < map.size_fine(); ++i) {
    const ExactMapRow& row = exact[static_cast<size_t>(i)];
    const BandedMap::Row rounded = map.row(i);
    EXPECT_EQ(sum_of(row), Rational(1)) << i;
    ASSERT_EQ(row.first, rounded.first) << i;
    ASSERT_EQ(static_cast<int>(row.coefficients.size()), rounded.count) << i;
    for (int k = 0; k < rounded.count; ++k) {
      const Rational& share = row.coefficients[static_cast<size_t>(k)];
      EXPECT_LE(roundoffs(rounded.coefficients[k], share, share), 6.0 * degree) << i << ' ' << k;
    }
  }
}

TEST(ExactRefinement, RowsAreThoseOfBoehm) {
  std::mt19937 random(31);
  for (int degree : {1, 2, 3, 5}) {
    for (const KnotVector& coarse : {testing::random_clamped(random, degree, 3),
                                     testing::random_unclamped(random, degree, 3)}) {
      const auto inserted = testing::random_insertions(random, coarse, 3);
      const ExactMap map = exact_insertion_map(coarse, with_knots(coarse, inserted));
      const auto expected = exact_insertion(coarse, inserted);
      ASSERT_EQ(map.size(), expected.size());
      for (size_t i = 0; i < map.size(); ++i) {
        for (size_t j = 0; j < expected[i].size(); ++j) {
          const int k = static_cast<int>(j) - map[i].first;
          const bool stored = 0 <= k && k < static_cast<int>(map[i].coefficients.size());
          EXPECT_EQ(stored ? map[i].coefficients[static_cast<size_t>(k)] : Rational(),
                    expected[i][j]);
        }
      }
    }
  }
}

TEST(ExactRefinement, RoundsToTheMapsInDoubles) {
  std::mt19937 random(32);
  for (int degree : {1, 2, 3, 7}) {
    const KnotVector coarse = testing::random_clamped(random, degree, 3);
    const KnotVector fine = with_knots(coarse, testing::random_insertions(random, coarse, 4));
    expect_rounds_to(exact_insertion_map(coarse, fine), insertion_map(coarse, fine), degree);
    expect_rounds_to(exact_insertion_map(fine, fine), insertion_map(fine, fine), degree);
  }
}

TEST(ExactRefinement, WrappedRowsRoundToTheWrappedMaps) {
  for (int degree : {2, 3, 4}) {
    for (int spans : {1, 2, 5}) {
      std::vector<double> knots;
      for (int i = -degree; i <= spans + degree; ++i) knots.push_back(i);
      const KnotVector coarse(degree, knots);
      ASSERT_EQ(wrapped_poles(coarse), degree);
      const KnotVector fine = wrapped_with_knots(coarse, {0.25, 0.5});
      expect_rounds_to(exact_wrapped_insertion_map(coarse, fine),
                       wrapped_insertion_map(coarse, fine), degree);
      expect_rounds_to(exact_wrapped_insertion_map(fine, fine), wrapped_insertion_map(fine, fine),
                       degree);
    }
  }
}

TEST(ExactRefinement, DerivativesAreThoseOfCoxAndDeBoor) {
  std::mt19937 random(33);
  for (int degree : {1, 2, 3, 6}) {
    const KnotVector knots = testing::random_clamped(random, degree, 3);
    for (int span : knots.spans()) {
      for (double t : {knots[span], knots[span + 1], 0.5 * (knots[span] + knots[span + 1])}) {
        for (int r = 0; r <= 2; ++r) {
          EXPECT_EQ(exact_derivatives(knots, span, t, r), exact_basis(knots, span, Rational(t), r))
              << degree << ' ' << r;
        }
      }
    }
  }
}

TEST(ExactRefinement, VectorsThatDoNotBelongTogetherAreTheCallersBug) {
  const KnotVector knots = KnotVector::uniform(2, 4);
  EXPECT_THROW(exact_insertion_map(with_knots(knots, {0.1}), knots), PreconditionError);
  EXPECT_THROW(exact_wrapped_insertion_map(knots, with_knots(knots, {0.1})), PreconditionError);
  EXPECT_THROW(exact_derivatives(knots, 0, 0.0, 1), PreconditionError);
  EXPECT_THROW(exact_derivatives(knots, 2, 0.0, -1), PreconditionError);
}

}  // namespace
}  // namespace isochor
