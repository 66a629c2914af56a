#include "isochor/ecles/constraint_matrix.h"

#include <gtest/gtest.h>

#include "isochor/base/error.h"

namespace isochor {
namespace {

Rational fraction(long a, long b) { return Rational(Integer(a), Integer(b)); }

TEST(ConstraintMatrix, StoresTheSmallestIntegerMultiple) {
  const ConstraintMatrix matrix(3, {{{2, fraction(-9, 10)}, {0, fraction(3, 4)}}});
  ASSERT_EQ(matrix.row(0).size(), 2u);
  EXPECT_EQ(matrix.scale(0), fraction(20, 3));
  EXPECT_EQ(matrix.row(0)[0].parameter, 0);
  EXPECT_EQ(matrix.row(0)[0].coefficient, Integer(5));
  EXPECT_EQ(matrix.row(0)[1].parameter, 2);
  EXPECT_EQ(matrix.row(0)[1].coefficient, Integer(-6));
}

TEST(ConstraintMatrix, AddsRepeatedParametersAndDropsZeros) {
  const ConstraintMatrix matrix(
      2, {{{1, Rational(2)}, {0, Rational(1)}, {1, Rational(-2)}}, {}, {{0, Rational(0)}}});
  EXPECT_EQ(matrix.rows(), 3);
  EXPECT_EQ(matrix.nonzeros(), 1u);
  EXPECT_EQ(matrix.row(0).size(), 1u);
  EXPECT_TRUE(matrix.row(1).empty());
  EXPECT_TRUE(matrix.row(2).empty());
  EXPECT_EQ(matrix.scale(1), Rational(1));
}

TEST(ConstraintMatrix, ColumnsListTheirRows) {
  const ConstraintMatrix matrix(
      3, {{{0, Rational(1)}, {2, Rational(1)}}, {{2, Rational(3)}}, {{0, Rational(5)}}});
  const auto rows = [&](int j) {
    return std::vector<int>(matrix.column(j).begin(), matrix.column(j).end());
  };
  EXPECT_EQ(rows(0), (std::vector<int>{0, 2}));
  EXPECT_EQ(rows(1), std::vector<int>{});
  EXPECT_EQ(rows(2), (std::vector<int>{0, 1}));
}

TEST(ConstraintMatrix, RefusesUnknownParameters) {
  EXPECT_THROW(ConstraintMatrix(2, {{{2, Rational(1)}}}), PreconditionError);
  EXPECT_THROW(ConstraintMatrix(2, {{{-1, Rational(1)}}}), PreconditionError);
  EXPECT_NO_THROW(ConstraintMatrix(0, {}));
}

}  // namespace
}  // namespace isochor
