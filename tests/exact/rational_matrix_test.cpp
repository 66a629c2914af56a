#include "isochor/exact/rational_matrix.h"

#include <gtest/gtest.h>

#include <random>

#include "isochor/base/error.h"

namespace isochor {
namespace {

RationalMatrix random_matrix(std::mt19937_64& random, int rows, int columns) {
  std::uniform_int_distribution<long> top(-60, 60);
  std::uniform_int_distribution<long> bottom(1, 12);
  RationalMatrix result(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) result.set(i, j, Rational(top(random), bottom(random)));
  }
  return result;
}

// The second method: Gauss and Jordan by the book. Returns the columns of its pivots.
std::vector<int> naive_echelon(RationalMatrix& a) {
  std::vector<int> pivots;
  for (int column = 0; column < a.columns(); ++column) {
    const auto row = static_cast<int>(pivots.size());
    int found = row;
    while (found < a.rows() && a.at(found, column).is_zero()) ++found;
    if (found == a.rows()) continue;
    const Rational pivot = a.at(found, column);
    for (int j = 0; j < a.columns(); ++j) {
      std::swap(a.at(row, j), a.at(found, j));
      a.at(row, j) /= pivot;
    }
    for (int i = 0; i < a.rows(); ++i) {
      const Rational factor = a.at(i, column);
      if (i == row) continue;
      for (int j = 0; j < a.columns(); ++j) a.at(i, j) -= factor * a.at(row, j);
    }
    pivots.push_back(column);
  }
  return pivots;
}

RationalMatrix naive_product(const RationalMatrix& a, const RationalMatrix& b) {
  RationalMatrix result(a.rows(), b.columns());
  for (int i = 0; i < a.rows(); ++i) {
    for (int j = 0; j < b.columns(); ++j) {
      for (int k = 0; k < a.columns(); ++k) result.at(i, j) += a.at(i, k) * b.at(k, j);
    }
  }
  return result;
}

TEST(RationalMatrix, RingLaws) {
  std::mt19937_64 random(31);
  for (int size = 0; size < 6; ++size) {
    const RationalMatrix a = random_matrix(random, size, 4);
    const RationalMatrix b = random_matrix(random, 4, 3);
    const RationalMatrix c = random_matrix(random, 4, 3);
    const RationalMatrix d = random_matrix(random, 3, size);
    EXPECT_EQ(a * b, naive_product(a, b));
    EXPECT_EQ((a * b) * d, a * (b * d));
    EXPECT_EQ(a * (b + c), a * b + a * c);
    EXPECT_EQ((b - c) + c, b);
    EXPECT_EQ((a * b).transpose(), b.transpose() * a.transpose());
    EXPECT_TRUE((a - a).is_zero());
  }
}

TEST(RationalMatrix, InverseLaws) {
  std::mt19937_64 random(32);
  for (int round = 0; round < 24; ++round) {
    const int size = round % 8;
    const int inner = round % 3 == 0 ? size : (size + 1) / 2;
    const RationalMatrix a =
        random_matrix(random, size, inner) * random_matrix(random, inner, size);
    RationalMatrix reduced = a;
    const bool regular = naive_echelon(reduced).size() == static_cast<size_t>(size);
    const auto inverse = a.inverse();
    ASSERT_EQ(inverse.has_value(), regular) << size;
    if (!inverse) continue;
    EXPECT_EQ(a * *inverse, RationalMatrix::identity(size));
    EXPECT_EQ(*inverse * a, RationalMatrix::identity(size));
  }
  EXPECT_THROW((void)RationalMatrix(2, 3).inverse(), PreconditionError);
}

TEST(RationalMatrix, SolveLaws) {
  std::mt19937_64 random(33);
  // FLINT changes its method near 25 rows.
  for (const int size : {1, 2, 5, 24, 30}) {
    RationalMatrix a = random_matrix(random, size, size);
    const RationalMatrix b = random_matrix(random, size, 2);
    const auto x = solve(a, b);
    ASSERT_TRUE(x.has_value());
    EXPECT_EQ(a * *x, b);
    for (int j = 0; j < size; ++j) a.set(size - 1, j, a.at(0, j) * Rational(7, 3));
    if (size > 1) {
      EXPECT_FALSE(solve(a, b).has_value());
      EXPECT_FALSE(solve(a, RationalMatrix(size, 0)).has_value());
      EXPECT_FALSE(solve(a, RationalMatrix(size, 1)).has_value());
    }
  }
  EXPECT_EQ(solve(RationalMatrix(), RationalMatrix(0, 3)), RationalMatrix(0, 3));
  EXPECT_EQ(solve(RationalMatrix::identity(2), RationalMatrix(2, 0)), RationalMatrix(2, 0));
  EXPECT_THROW((void)solve(RationalMatrix(2, 2), RationalMatrix(3, 1)), PreconditionError);
  EXPECT_THROW((void)solve(RationalMatrix(2, 3), RationalMatrix(2, 1)), PreconditionError);
}

TEST(RationalMatrix, EchelonLaws) {
  std::mt19937_64 random(34);
  for (int inner = 0; inner <= 5; ++inner) {
    const RationalMatrix a = random_matrix(random, 5, inner) * random_matrix(random, inner, 7);
    RationalMatrix expected = a;
    const std::vector<int> pivots = naive_echelon(expected);
    const EchelonForm echelon = a.reduced_row_echelon();
    EXPECT_EQ(echelon.form, expected);
    EXPECT_EQ(echelon.pivot_columns, pivots);
  }
  for (const auto& [rows, columns] : {std::pair(0, 0), std::pair(0, 3), std::pair(3, 0)}) {
    const EchelonForm echelon = RationalMatrix(rows, columns).reduced_row_echelon();
    EXPECT_EQ(echelon.form, RationalMatrix(rows, columns));
    EXPECT_TRUE(echelon.pivot_columns.empty());
  }
}

TEST(RationalMatrix, HugeAndTinyEntries) {
  RationalMatrix a(2, 2);
  a.set(0, 0, Rational(1).scaled_by_power_of_two(200));
  a.set(0, 1, Rational(1));
  a.set(1, 0, Rational(1));
  a.set(1, 1, Rational(1).scaled_by_power_of_two(-200));
  EXPECT_FALSE(a.inverse().has_value());
  a.at(1, 1) += Rational(1).scaled_by_power_of_two(-400);
  EXPECT_EQ(a * a.inverse().value(), RationalMatrix::identity(2));
}

TEST(RationalMatrix, SizesMustFit) {
  EXPECT_THROW(RationalMatrix(2, -1), PreconditionError);
  EXPECT_THROW(RationalMatrix(1, 2, {Rational(1)}), PreconditionError);
  EXPECT_THROW(RationalMatrix(1, 2) * RationalMatrix(1, 2), PreconditionError);
  EXPECT_THROW(RationalMatrix(1, 2) + RationalMatrix(2, 1), PreconditionError);
  EXPECT_THROW(RationalMatrix(1, 2) - RationalMatrix(2, 1), PreconditionError);
}

TEST(RationalMatrix, IntegersAreRationals) {
  IntegerMatrix integers(1, 2);
  integers.set(0, 1, -5);
  const RationalMatrix a = integers;
  EXPECT_EQ(a.at(0, 0), Rational(0));
  EXPECT_EQ(a.at(0, 1), Rational(-5));
}

}  // namespace
}  // namespace isochor
