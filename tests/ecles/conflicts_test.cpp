#include "isochor/ecles/conflicts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "isochor/base/error.h"
#include "isochor/ecles/proof.h"

namespace isochor {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Rational fraction(long a, long b) { return Rational(Integer(a), Integer(b)); }

// x0 / 2 + x1 / 2 = 1 and 2 x0 + 2 x1 = q: the same line, or two parallel ones.
ConstraintMatrix parallels() {
  return ConstraintMatrix(3, {{{0, fraction(1, 2)}, {1, fraction(1, 2)}},
                              {{0, Rational(2)}, {1, Rational(2)}},
                              {{1, Rational(1)}, {2, Rational(-1)}}});
}

TEST(Conflicts, MultipliersOfTheGivenConstraintsProveThem) {
  const ConstraintMatrix matrix = parallels();
  const Selection selection{{2}, {0, 1}};
  const Analysis analysis = analyse(matrix, selection);
  ASSERT_EQ(analysis.circuits.size(), 1u);
  EXPECT_THAT(analysis.circuits[0].rows, ElementsAre(0, 1));
  // 2 (first) - 1/2 (second) = 0 for all x.
  EXPECT_THAT(given_multipliers(matrix, analysis.circuits[0]),
              ElementsAre(Rational(2), fraction(-1, 2)));
  const std::vector<std::vector<Rational>> values(2, std::vector<Rational>(3));
  const std::vector<std::vector<Rational>> right_sides{{Rational(1), Rational(4), Rational(7)},
                                                       {Rational(1), Rational(5), Rational(7)}};
  const std::vector<Conflict> found = conflicts(matrix, analysis, right_sides, values);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].circuit, 0);
  EXPECT_EQ(found[0].component, 1);
  EXPECT_EQ(found[0].residual, fraction(-1, 2));  // 2 * 1 - 5 / 2
  EXPECT_TRUE(
      verify_conflict(analysis.circuits[0], found[0], matrix, selection, right_sides, values));
  Conflict wrong = found[0];
  wrong.residual = fraction(1, 2);
  EXPECT_FALSE(
      verify_conflict(analysis.circuits[0], wrong, matrix, selection, right_sides, values));
  wrong = found[0];
  wrong.component = 2;
  EXPECT_FALSE(
      verify_conflict(analysis.circuits[0], wrong, matrix, selection, right_sides, values));
}

TEST(Conflicts, FollowTheValuesOfFixedParametersAndAnchors) {
  // x0 = x1 with x0 anchored and x1 fixed: row 0 on anchors alone.
  const ConstraintMatrix matrix(3, {{{0, Rational(1)}, {1, Rational(-1)}}});
  const Selection selection{{0}, {2}};
  const Analysis analysis = analyse(matrix, selection);
  EXPECT_FALSE(analysis.strongly_solvable());
  const std::vector<std::vector<Rational>> zero{{Rational(0)}};
  const auto found = [&](long x0, long x1) {
    return conflicts(matrix, analysis, zero, {{Rational(x0), Rational(x1), Rational(0)}});
  };
  EXPECT_THAT(found(3, 3), IsEmpty());
  ASSERT_EQ(found(3, 4).size(), 1u);
  EXPECT_EQ(found(3, 4)[0].residual, Rational(1));
}

TEST(Conflicts, RefuseTablesOfTheWrongSize) {
  const ConstraintMatrix matrix = parallels();
  const Analysis analysis = analyse(matrix, {{}, {0, 1, 2}});
  const std::vector<Rational> three(3), two(2);
  EXPECT_THROW(conflicts(matrix, analysis, {three}, {}), PreconditionError);
  EXPECT_THROW(conflicts(matrix, analysis, {two}, {three}), PreconditionError);
  EXPECT_THROW(conflicts(matrix, analysis, {three}, {two}), PreconditionError);
}

}  // namespace
}  // namespace isochor
