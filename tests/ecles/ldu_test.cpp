#include "isochor/ecles/ldu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "ecles/matrix_tables.h"
#include "ecles/rational_elimination.h"
#include "isochor/base/error.h"

namespace isochor {
namespace {

using test::integers;
using test::RandomMatrix;
using test::Table;
using test::table_of;

constexpr Simplification kAll[] = {Simplification::kNone, Simplification::kGcd,
                                   Simplification::kTurner};

IntegerMatrix example_4_3() {
  return integers(
      {{4, 9, 16, 29}, {-1, -6, -19, -16}, {1, 5, 15, 19}, {5, 6, -1, -12}, {5, 10, 15, 20}});
}

IntegerMatrix example_7() {
  return integers({{8, 7, 4, 1}, {4, 6, 7, 3}, {6, 3, 4, 6}, {4, 5, 8, 2}});
}

IntegerMatrix right_side_8_3() { return integers({{142}, {42}, {40}, {-128}, {50}}); }

// Each law that a factoring of A obeys, whatever made it.
void expect_factoring(const IntegerMatrix& a, const LduFactoring& factoring) {
  ASSERT_EQ(factoring.rows(), a.rows());
  ASSERT_EQ(factoring.columns(), a.columns());
  EXPECT_EQ(product(factoring), RationalMatrix(a));
  const Table table = table_of(a);
  EXPECT_EQ(static_cast<size_t>(factoring.rank()), test::rank(table));
  Table independent;
  for (int k = 0; k < factoring.rank(); ++k) {
    const auto row = static_cast<size_t>(factoring.row_order[static_cast<size_t>(k)]);
    independent.push_back(table[row]);
    EXPECT_FALSE(factoring.lower.at(k, k).is_zero());
    EXPECT_FALSE(factoring.upper.at(k, k).is_zero());
    for (int s = k + 1; s < factoring.rank(); ++s) {
      EXPECT_TRUE(factoring.lower.at(k, s).is_zero());
      EXPECT_TRUE(factoring.upper.at(s, k).is_zero());
    }
  }
  EXPECT_EQ(test::rank(independent), independent.size());
}

TEST(Ldu, Example43EntryForEntry) {
  const LduFactoring factoring = factor_ldu(example_4_3(), Simplification::kTurner);
  EXPECT_EQ(factoring.row_order, (std::vector<int>{1, 2, 0, 3, 4}));
  EXPECT_EQ(factoring.column_order, (std::vector<int>{0, 1, 3, 2}));
  EXPECT_EQ(factoring.lower,
            integers({{-1, 0, 0}, {1, 1, 0}, {4, 15, -80}, {5, 24, -164}, {5, 20, -120}}));
  EXPECT_EQ(factoring.diagonal, (std::vector<Integer>{-1, -1, -80}));
  EXPECT_EQ(factoring.upper, integers({{-1, -6, -16, -19}, {0, 1, -3, 4}, {0, 0, -80, 0}}));
  for (const Simplification simplification : kAll) {
    expect_factoring(example_4_3(), factor_ldu(example_4_3(), simplification));
  }
}

TEST(Ldu, Example83Solved) {
  const RationalMatrix right(right_side_8_3());
  for (const Simplification simplification : kAll) {
    const LduFactoring factoring = factor_ldu(example_4_3(), simplification);
    EXPECT_TRUE(reaches(factoring, right));  // (8.19)
    const RationalMatrix solution = particular_solution(factoring, right);
    // (8.22) with the last permutation applied: the third parameter is the free one.
    EXPECT_EQ(solution,
              test::column_of({Rational(59), Rational(-95, 2), Rational(0), Rational(23, 2)}));
    EXPECT_EQ(RationalMatrix(example_4_3()) * solution, right);
    // What is printed there does not solve the system.
    const RationalMatrix printed =
        test::column_of({Rational(59), Rational(-95, 2), Rational(23, 2), Rational(0)});
    EXPECT_EQ(RationalMatrix(example_4_3()) * printed - right,
              test::column_of({Rational(-299, 2), Rational(-69, 2), Rational(-46), Rational(253, 2),
                               Rational(-115, 2)}));
    RationalMatrix spoiled = right;
    spoiled.at(4, 0) += Rational(1);
    EXPECT_FALSE(reaches(factoring, spoiled));
  }
}

// What pivoting cannot change of the matrix of section 7.
TEST(Ldu, Example7Determinant) {
  const Integer determinant = example_7().determinant();
  EXPECT_EQ(determinant, -450);  // the last entry printed in 7.3
  const LduFactoring turner = factor_ldu(example_7(), Simplification::kTurner);
  EXPECT_EQ(turner.upper.at(3, 3).abs(), 450);
  for (const Simplification simplification : kAll) {
    expect_factoring(example_7(), factor_ldu(example_7(), simplification));
  }
  const LduFactoring by_gcd = factor_ldu(example_7(), Simplification::kGcd);
  for (int k = 0; k < 4; ++k) {
    Integer common;
    for (int s = 0; s < 4; ++s) common = gcd(common, by_gcd.upper.at(k, s));
    EXPECT_EQ(common, 1);
  }
}

// The rows printed in section 7, which does not pivot. Row i and column j times 1000^i and 1000^j
// keep the least entry at the upper left, so that full pivoting stays in place; the entries differ
// from the printed ones by powers of 1000 that are known.
TEST(Ldu, Example7StepsWithPivotsInPlace) {
  const auto power = [](int exponent) {
    Integer result(1);
    for (int k = 0; k < exponent; ++k) result *= 1000;
    return result;
  };
  IntegerMatrix scaled = example_7();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) scaled.at(i, j) *= power(i + j);
  }
  const LduFactoring none = factor_ldu(scaled, Simplification::kNone);
  const LduFactoring turner = factor_ldu(scaled, Simplification::kTurner);
  const std::vector<int> in_place{0, 1, 2, 3};
  ASSERT_EQ(none.row_order, in_place);
  ASSERT_EQ(none.column_order, in_place);
  const IntegerMatrix plain =
      integers({{8, 7, 4, 1}, {0, 20, 40, 20}, {0, 0, 880, 1200}, {0, 0, 0, -576000}});
  const IntegerMatrix by_turner =
      integers({{8, 7, 4, 1}, {0, 20, 40, 20}, {0, 0, 110, 150}, {0, 0, 0, -450}});
  // Step i multiplies the rows below by U_ii: 1000^0, 1000^2, 1000^6. An entry of Turner's is a
  // minor of the first i rows and columns, row i and column j: 1000^(i i + j).
  const int plain_row[] = {0, 1, 4, 11};
  for (int i = 0; i < 4; ++i) {
    for (int j = i; j < 4; ++j) {
      EXPECT_EQ(none.upper.at(i, j), plain.at(i, j) * power(plain_row[i] + j)) << i << " " << j;
      EXPECT_EQ(turner.upper.at(i, j), by_turner.at(i, j) * power(i * i + j)) << i << " " << j;
    }
  }
  // By greatest common divisors the last two rows come as (11, 15) and (1, 0) in 7.2: the second is
  // the better pivot, so full pivoting exchanges them and leaves 1 after eliminating. (Here the
  // scaled first row has a divisor, 8, too.)
  const LduFactoring by_gcd = factor_ldu(scaled, Simplification::kGcd);
  EXPECT_EQ(by_gcd.row_order, (std::vector<int>{0, 1, 3, 2}));
  EXPECT_EQ(
      by_gcd.upper,
      integers({{1, 875, 500000, 125000000}, {0, 1, 2000, 1000000}, {0, 0, 1, 0}, {0, 0, 0, 1}}));
}

TEST(Ldu, TurnerEntriesAreMinors) {
  std::mt19937_64 random(41);
  for (int size = 1; size <= 8; ++size) {
    const IntegerMatrix a = test::random_matrix(random, {size, size, -1, 1.0, 12});
    const LduFactoring factoring = factor_ldu(a, Simplification::kTurner);
    ASSERT_EQ(factoring.rank(), size);
    EXPECT_EQ(factoring.upper.at(size - 1, size - 1).abs(), a.determinant().abs());
    EXPECT_EQ(factoring.diagonal[0], factoring.upper.at(0, 0));
    for (int k = 1; k < size; ++k) {
      EXPECT_EQ(factoring.diagonal[static_cast<size_t>(k)],
                factoring.upper.at(k - 1, k - 1) * factoring.upper.at(k, k));
      IntegerMatrix leading(k + 1, k + 1);
      for (int i = 0; i <= k; ++i) {
        for (int j = 0; j <= k; ++j) {
          leading.set(i, j,
                      a.at(factoring.row_order[static_cast<size_t>(i)],
                           factoring.column_order[static_cast<size_t>(j)]));
        }
      }
      EXPECT_EQ(factoring.upper.at(k, k), leading.determinant());
    }
  }
}

// Section 8.1 says that D L^-1 is an integer matrix, whatever the simplification.
TEST(Ldu, DiagonalOverLowerIsIntegerButByGcd) {
  std::mt19937_64 random(46);
  int fractional_by_gcd = 0;
  for (int round = 0; round < 40; ++round) {
    const IntegerMatrix a = test::random_matrix(random, {4, 4, -1, 1.0, 8});
    for (const Simplification simplification : kAll) {
      const LduFactoring factoring = factor_ldu(a, simplification);
      RationalMatrix inverse = RationalMatrix(factoring.lower).inverse().value();
      bool integral = true;
      for (int k = 0; k < 4; ++k) {
        for (int s = 0; s < 4; ++s) {
          inverse.at(k, s) *= factoring.diagonal[static_cast<size_t>(k)];
          integral = integral && inverse.at(k, s).denominator() == 1;
        }
      }
      if (simplification == Simplification::kGcd) {
        fractional_by_gcd += integral ? 0 : 1;
      } else {
        EXPECT_TRUE(integral);
      }
    }
  }
  EXPECT_GT(fractional_by_gcd, 30);
}

TEST(Ldu, PivotIsTheFirstLeastEntry) {
  // Three entries of magnitude 2; the first row by row is at (0, 2).
  const LduFactoring factoring =
      factor_ldu(integers({{3, 5, -2}, {2, 7, 4}, {2, 9, 8}}), Simplification::kTurner);
  EXPECT_EQ(factoring.row_order[0], 0);
  EXPECT_EQ(factoring.column_order[0], 2);
  EXPECT_EQ(factoring.upper.at(0, 0), -2);
}

TEST(Ldu, FactorsOfEveryRankAndShape) {
  std::mt19937_64 random(42);
  for (int rows = 0; rows <= 7; ++rows) {
    for (int columns = 0; columns <= 7; ++columns) {
      for (int rank = 0; rank <= std::min(rows, columns); ++rank) {
        const IntegerMatrix a = test::random_matrix(random, {rows, columns, rank, 1.0, 3});
        for (const Simplification simplification : kAll) {
          SCOPED_TRACE(::testing::Message() << rows << " x " << columns << ", rank " << rank);
          expect_factoring(a, factor_ldu(a, simplification));
        }
      }
    }
  }
}

TEST(Ldu, FactorsOfRandomSystems) {
  // Without simplification bits double with each step: only small ones.
  const struct {
    RandomMatrix matrix;
    bool none;
  } cases[] = {
      {{60, 60, -1, 1.0, 4}, false},   {{60, 60, 12, 1.0, 4}, false},
      {{60, 40, -1, 0.05, 10}, false}, {{40, 60, -1, 0.08, 10}, false},
      {{60, 60, 31, 0.1, 3}, false},   {{12, 9, -1, 1.0, 200}, false},
      {{9, 14, 5, 0.5, 200}, true},    {{25, 25, -1, 0.04, 30}, true},
      {{8, 8, -1, 1.0, 10}, true},     {{1, 60, -1, 0.5, 10}, true},
      {{60, 1, -1, 0.5, 10}, true},    {{60, 60, -1, 0.01, 10}, false},
  };
  unsigned long seed = 4500;
  for (const auto& [wanted, none] : cases) {
    ++seed;
    std::mt19937_64 random(seed);
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", " << wanted.rows << " x "
                                      << wanted.columns << ", density " << wanted.density);
    const IntegerMatrix a = test::random_matrix(random, wanted);
    expect_factoring(a, factor_ldu(a, Simplification::kGcd));
    expect_factoring(a, factor_ldu(a, Simplification::kTurner));
    if (none) expect_factoring(a, factor_ldu(a, Simplification::kNone));
  }
}

TEST(Ldu, SolutionsExistWhereReached) {
  std::mt19937_64 random(43);
  for (int round = 0; round < 60; ++round) {
    const int rows = round % 8;
    const int columns = round % 5;
    const int rank = std::min({rows, columns, round % 4});
    const IntegerMatrix a = test::random_matrix(random, {rows, columns, rank, 1.0, 6});
    const int components = round % 3;
    RationalMatrix right =
        RationalMatrix(a) * RationalMatrix(test::random_full(random, columns, components, 1.0, 9));
    for (const Simplification simplification : kAll) {
      const LduFactoring factoring = factor_ldu(a, simplification);
      EXPECT_TRUE(reaches(factoring, right));
      EXPECT_EQ(RationalMatrix(a) * particular_solution(factoring, right), right);
      if (rows == 0 || components == 0) continue;
      RationalMatrix moved = right;
      moved.at(rows - 1, components - 1) += Rational(1, 7);
      const bool expected = test::in_column_space(table_of(a), table_of(moved));
      EXPECT_EQ(reaches(factoring, moved), expected);
      EXPECT_EQ(RationalMatrix(a) * particular_solution(factoring, moved) == moved, expected);
    }
  }
}

TEST(Ldu, ObserverSeesEveryStep) {
  std::mt19937_64 random(44);
  const IntegerMatrix a = test::random_matrix(random, {12, 12, -1, 1.0, 10});
  std::vector<LduStep> steps;
  const auto record = [&](const LduStep& step) { steps.push_back(step); };
  const LduFactoring by_gcd = factor_ldu(a, Simplification::kGcd, record);
  ASSERT_EQ(static_cast<int>(steps.size()), by_gcd.rank());
  unsigned long largest_diagonal = 0;
  for (size_t k = 0; k < steps.size(); ++k) {
    EXPECT_EQ(steps[k].step, static_cast<int>(k) + 1);
    largest_diagonal = std::max(largest_diagonal, steps[k].diagonal_bits);
  }
  EXPECT_GE(steps.back().upper_bits, by_gcd.upper.max_bits());
  EXPECT_GE(steps.back().lower_bits, by_gcd.lower.max_bits());
  // The products that wait for their column's division are far longer than what remains of them.
  unsigned long final_diagonal = 0;
  for (const Integer& entry : by_gcd.diagonal)
    final_diagonal = std::max(final_diagonal, entry.bits());
  EXPECT_GT(largest_diagonal, final_diagonal * 3 / 2);
}

TEST(Ldu, RightSidesMustFit) {
  const LduFactoring factoring = factor_ldu(example_4_3(), Simplification::kGcd);
  EXPECT_THROW((void)reaches(factoring, RationalMatrix(4, 1)), PreconditionError);
  EXPECT_THROW((void)particular_solution(factoring, RationalMatrix(6, 1)), PreconditionError);
}

}  // namespace
}  // namespace isochor
