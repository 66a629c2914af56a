#include "isochor/ecles/positive_system.h"

#include <gtest/gtest.h>

#include <random>

#include "isochor/base/error.h"

namespace isochor::internal {
namespace {

constexpr int kSeed = 20170411;

using Dense = std::vector<std::vector<Integer>>;

SparseIntegerRows sparse(const Dense& dense) {
  SparseIntegerRows rows(dense.size());
  for (size_t i = 0; i < dense.size(); ++i)
    for (size_t j = 0; j < dense.size(); ++j)
      if (!dense[i][j].is_zero()) rows[i].emplace_back(static_cast<int>(j), dense[i][j]);
  return rows;
}

// A A^T for a sparse random A with a diagonal, so that it is positive definite.
Dense random_positive(int n, long size, std::mt19937& random) {
  Dense a(n, std::vector<Integer>(n)), result = a;
  std::uniform_int_distribution<long> entry(-size, size);
  for (int i = 0; i < n; ++i) {
    a[i][i] = size + 1;
    for (int k = 0; k < 3; ++k) {
      const int j = std::uniform_int_distribution<int>(0, n - 1)(random);
      if (j > i) a[i][j] = entry(random);
    }
  }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) result[i][j].add_product(a[i][k], a[j][k]);
  return result;
}

void expect_solves(const Dense& matrix, const CommonFractions& y,
                   const std::vector<Integer>& right) {
  EXPECT_EQ(y.denominator.sign(), 1);
  Integer common = y.denominator;
  for (size_t i = 0; i < matrix.size(); ++i) {
    Integer sum;
    for (size_t j = 0; j < matrix.size(); ++j) sum.add_product(matrix[i][j], y.numerators[j]);
    EXPECT_EQ(sum, y.denominator * right[i]);
    common = gcd(common, y.numerators[i]);
  }
  EXPECT_EQ(common, Integer(1));
}

TEST(PositiveSystem, LiftingAndEliminationGiveTheSameFractions) {
  std::mt19937 random(kSeed);
  for (const int n : {1, 2, 7, 20, 45}) {
    for (const long size : {3L, 1L << 12, 1L << 30}) {
      const Dense matrix = random_positive(n, size, random);
      const PositiveSystem system(sparse(matrix));
      std::vector<Integer> right;
      for (int i = 0; i < n; ++i)
        right.push_back(std::uniform_int_distribution<long>(-size * 1000, size * 1000)(random));
      const auto eliminated = system.solve(right, PositiveSystem::Rung::kElimination);
      const auto lifted = system.solve(right, PositiveSystem::Rung::kLifting);
      const auto either = system.solve(right);
      ASSERT_TRUE(lifted) << n << " " << size;
      expect_solves(matrix, *eliminated, right);
      EXPECT_EQ(lifted->denominator, eliminated->denominator);
      EXPECT_EQ(lifted->numerators, eliminated->numerators);
      EXPECT_EQ(either->numerators, eliminated->numerators);
    }
  }
}

TEST(PositiveSystem, SolutionsWithFewBinaryDigitsNeedNoFractions) {
  const Dense matrix = {{4, 1}, {1, 4}};
  const PositiveSystem system(sparse(matrix));
  const std::vector<Integer> right = {Integer(9), Integer(6)};  // y = (2, 1)
  const auto lifted = system.solve(right, PositiveSystem::Rung::kLifting);
  ASSERT_TRUE(lifted);
  EXPECT_EQ(lifted->denominator, Integer(1));
  EXPECT_EQ(lifted->numerators, (std::vector<Integer>{2, 1}));
  EXPECT_EQ(system.solve({0, 0}, PositiveSystem::Rung::kLifting)->denominator, Integer(1));
}

TEST(PositiveSystem, EntriesFarBeyondDoubleAreSolved) {
  const Integer huge = Integer(1).shifted(3000);
  const Dense matrix = {{huge * Integer(5), huge}, {huge, huge * Integer(3)}};
  const PositiveSystem system(sparse(matrix));
  const std::vector<Integer> right = {Integer(7), huge * huge};
  for (const auto rung : {PositiveSystem::Rung::kElimination, PositiveSystem::Rung::kLifting}) {
    const auto y = system.solve(right, rung);
    ASSERT_TRUE(y);
    expect_solves(matrix, *y, right);
  }
}

TEST(PositiveSystem, WhatDoublesCannotFactorIsEliminated) {
  // Determinant 1, entries of 200 bits: after scaling the rows agree to 400 bits.
  const Integer k = Integer(1).shifted(200);
  const Dense matrix = {{k * k + Integer(1), k}, {k, Integer(1)}};
  const PositiveSystem system(sparse(matrix));
  const std::vector<Integer> right = {Integer(1), Integer(0)};
  EXPECT_FALSE(system.factored() && system.solve(right, PositiveSystem::Rung::kLifting));
  const auto y = system.solve(right);
  expect_solves(matrix, *y, right);
  EXPECT_EQ(y->numerators[1], -k);
  // Fifteen of them side by side, beyond what is eliminated.
  Dense many(30, std::vector<Integer>(30));
  std::vector<Integer> ones(30, Integer(1));
  for (size_t b = 0; b < 30; b += 2)
    for (size_t i = 0; i < 4; ++i) many[b + i / 2][b + i % 2] = matrix[i / 2][i % 2];
  const PositiveSystem large(sparse(many));
  EXPECT_FALSE(large.factored() && large.solve(ones, PositiveSystem::Rung::kLifting));
  const auto solution = large.solve(ones);
  expect_solves(many, *solution, ones);
  EXPECT_EQ(solution->numerators,
            large.solve(ones, PositiveSystem::Rung::kElimination)->numerators);
}

TEST(PositiveSystem, RefusesMatricesThatAreNotPositive) {
  EXPECT_THROW(PositiveSystem(sparse({{0, 1}, {1, 2}})), PreconditionError);
  const PositiveSystem singular(sparse({{1, 1}, {1, 1}}));
  EXPECT_THROW(static_cast<void>(singular.solve({1, 1})), PreconditionError);
  EXPECT_THROW(static_cast<void>(singular.solve({1})), PreconditionError);
  const PositiveSystem empty(SparseIntegerRows{});
  EXPECT_TRUE(empty.solve({})->numerators.empty());
}

}  // namespace
}  // namespace isochor::internal
