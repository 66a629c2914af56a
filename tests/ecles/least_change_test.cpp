#include "isochor/ecles/least_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isochor/base/error.h"

namespace isochor {
namespace {

constexpr int kSeed = 20170411;

using Vector = std::vector<Rational>;

Rational fraction(long a, long b) { return Rational(Integer(a), Integer(b)); }

// Whether the columns in `basis` combine to `target`: rational elimination.
bool combines(std::vector<Vector> basis, Vector target) {
  size_t place = 0;
  for (size_t c = 0; c < basis.size(); ++c) {
    size_t pivot = place;
    while (pivot < target.size() && basis[c][pivot].is_zero()) ++pivot;
    if (pivot == target.size()) continue;
    for (size_t k = 0; k < basis.size(); ++k) std::swap(basis[k][pivot], basis[k][place]);
    std::swap(target[pivot], target[place]);
    for (size_t i = place + 1; i < target.size(); ++i) {
      const Rational factor = basis[c][i] / basis[c][place];
      for (size_t k = c; k < basis.size(); ++k) basis[k][i] -= factor * basis[k][place];
      target[i] -= factor * target[place];
    }
    ++place;
  }
  for (; place < target.size(); ++place)
    if (!target[place].is_zero()) return false;
  return true;
}

struct Problem {
  int parameters = 0;
  std::vector<RationalTerms> rows;
  Vector right_sides, values, weights;
  std::vector<int> derived, independent;
};

Rational given_residual(const Problem& problem, size_t row, const Vector& values) {
  Rational rest = problem.right_sides[row];
  for (const auto& [j, a] : problem.rows[row]) rest -= a * values[static_cast<size_t>(j)];
  return rest;
}

// Laws 1 and 2: primal feasible and stationary, which together are the optimum.
void expect_optimal(const Problem& problem, const Vector& solution) {
  Vector values = problem.values, gradient;
  for (size_t k = 0; k < solution.size(); ++k) {
    const auto j = static_cast<size_t>(problem.derived[k]);
    values[j] = solution[k];
    const Rational weight = problem.weights.empty() ? Rational(1) : problem.weights[k];
    gradient.push_back(weight * (solution[k] - problem.values[j]));
  }
  std::vector<Vector> normals;
  for (const int i : problem.independent) {
    EXPECT_TRUE(given_residual(problem, static_cast<size_t>(i), values).is_zero()) << i;
    Vector normal;
    for (const int j : problem.derived) {
      Rational sum;
      for (const auto& [parameter, a] : problem.rows[static_cast<size_t>(i)])
        if (parameter == j) sum += a;
      normal.push_back(sum);
    }
    normals.push_back(std::move(normal));
  }
  EXPECT_TRUE(combines(normals, gradient));
}

// Rows of a staircase on every second parameter, so that they are independent on `derived`.
Problem random_problem(int n, int rows, long size, std::mt19937& random) {
  Problem problem;
  problem.parameters = 2 * n;
  std::uniform_int_distribution<long> entry(-size, size), denominator(1, 9);
  const auto number = [&] { return fraction(entry(random), denominator(random)); };
  for (int j = 0; j < 2 * n; ++j) problem.values.push_back(number());
  for (int j = 0; j < n; ++j) {
    problem.derived.push_back(2 * j);
    problem.weights.push_back(fraction(1 + std::abs(entry(random)), denominator(random)));
  }
  for (int i = 0; i < rows; ++i) {
    RationalTerms terms = {{2 * i, fraction(size, 7)}};
    for (int k = 0; k < 4; ++k) {
      const int j = std::uniform_int_distribution<int>(0, 2 * n - 1)(random);
      if (j % 2 == 1 || j / 2 > i) terms.emplace_back(j, number());
    }
    problem.rows.push_back(terms);
    problem.right_sides.push_back(number());
    problem.independent.push_back(i);
  }
  return problem;
}

LeastChange make(const Problem& problem) {
  return LeastChange(ConstraintMatrix(problem.parameters, problem.rows), problem.derived,
                     problem.independent, problem.weights);
}

std::vector<double> rounded(const Vector& values) {
  std::vector<double> result;
  for (const Rational& value : values) result.push_back(value.to_double());
  return result;
}

TEST(LeastChange, DividesTheMissingPartByTheInverseWeights) {
  // x0 + 2 x1 = 7 from (1, 1) with weights 1, 2: missing 4, S = 1 + 4/2 = 3, change (4/3, 4/3).
  Problem problem{3, {{{0, 1}, {1, 2}}}, {7}, {1, 1, 5}, {1, 2, 3}, {0, 1, 2}, {0}};
  const Vector solution = make(problem).solve(problem.right_sides, problem.values);
  EXPECT_EQ(solution, (Vector{fraction(7, 3), fraction(7, 3), 5}));
  expect_optimal(problem, solution);
}

TEST(LeastChange, IsFeasibleAndStationary) {
  std::mt19937 random(kSeed);
  for (int round = 0; round < 30; ++round) {
    const int n = 2 + round, rows = 1 + (round * 5) % n;
    const Problem problem = random_problem(n, rows, round % 3 == 0 ? 1L << 40 : 50, random);
    expect_optimal(problem, make(problem).solve(problem.right_sides, problem.values));
  }
}

TEST(LeastChange, UntouchedParametersKeepTheirHints) {
  const Problem problem{4, {{{0, 1}, {1, 1}}}, {1}, {3, 4, fraction(1, 3), 9}, {}, {0, 2, 1}, {0}};
  const LeastChange change = make(problem);
  EXPECT_EQ(change.blocks(), 1);
  EXPECT_EQ(change.solve(problem.right_sides, problem.values)[1], fraction(1, 3));
  const double odd = 0.1 + 0.2;
  EXPECT_EQ(change.approximate({1.0}, {3.0, 4.0, odd, 9.0}).derived[1], odd);
}

TEST(LeastChange, RowsThatDoNotMeetAreBlocksOfTheirOwn) {
  Problem problem{6, {}, {0, 0, 0}, {1, 2, 3, 4, 5, 6}, {}, {0, 1, 2, 3, 4}, {0, 1, 2}};
  problem.rows = {{{0, 1}, {1, 1}, {5, 1}}, {{2, 1}, {3, 2}, {5, 1}}, {{3, 1}, {4, 1}}};
  const LeastChange change = make(problem);
  EXPECT_EQ(change.blocks(), 2);  // rows 1 and 2 share parameter 3, all share only the fixed 5
  expect_optimal(problem, change.solve(problem.right_sides, problem.values));
}

TEST(LeastChange, DoublesStayCloseToTheExactOptimum) {
  std::mt19937 random(kSeed + 1);
  for (int round = 0; round < 30; ++round) {
    const Problem problem = random_problem(3 + 2 * round, 2 + round, 1000, random);
    const LeastChange change = make(problem);
    Problem dyadic = problem;
    for (Vector* list : {&dyadic.right_sides, &dyadic.values})
      for (Rational& value : *list) value = Rational(value.to_double());
    const Vector exact = change.solve(dyadic.right_sides, dyadic.values);
    const auto result = change.approximate(rounded(problem.right_sides), rounded(problem.values));
    for (size_t k = 0; k < exact.size(); ++k)
      EXPECT_LE(std::fabs((exact[k] - Rational(result.derived[k])).to_double()),
                result.last_change);
    EXPECT_LT(result.last_change, 1e-8);
  }
}

TEST(LeastChange, EnclosesTheExactResidualOfDoubles) {
  std::mt19937 random(kSeed + 2);
  for (int round = 0; round < 40; ++round) {
    const long size = round % 2 == 0 ? 9 : 1L << 57;  // coefficients beyond 53 bits too
    const Problem problem = random_problem(12, 9, size, random);
    const auto right_sides = rounded(problem.right_sides);
    std::vector<double> values = rounded(problem.values);
    const auto result = make(problem).approximate(right_sides, values);
    for (size_t k = 0; k < result.derived.size(); ++k)
      values[static_cast<size_t>(problem.derived[k])] = result.derived[k];
    Problem dyadic = problem;
    for (size_t i = 0; i < right_sides.size(); ++i)
      dyadic.right_sides[i] = Rational(right_sides[i]);
    Vector exact_values;
    for (const double value : values) exact_values.emplace_back(value);
    Rational largest;
    for (size_t i = 0; i < right_sides.size(); ++i)
      largest = std::max(largest, given_residual(dyadic, i, exact_values).abs());
    EXPECT_LE(Rational(result.residual.low), largest);
    EXPECT_GE(Rational(result.residual.high), largest);
    EXPECT_LT(result.residual.high, 1e-9 * static_cast<double>(size) * static_cast<double>(size));
  }
}

TEST(LeastChange, ExtremeWeightsAreSolvedExactlyAndRounded) {
  const Rational huge = Rational(1).scaled_by_power_of_two(800);
  const Problem problem{2,  {{{0, 1}, {1, 1}}}, {3}, {1, 1}, {huge, Rational(1) / huge}, {0, 1},
                        {0}};
  const LeastChange change = make(problem);
  expect_optimal(problem, change.solve(problem.right_sides, problem.values));
  const auto result = change.approximate({3.0}, {1.0, 1.0});
  EXPECT_EQ(result.derived, (std::vector<double>{1.0, 2.0}));
  EXPECT_LT(result.residual.high, 1e-28);
}

TEST(LeastChange, NothingDerivedAndNoRows) {
  const ConstraintMatrix matrix(2, {{{0, Rational(1)}}});
  EXPECT_TRUE(LeastChange(matrix, {}, {}).solve({Rational(1)}, {1, 2}).empty());
  EXPECT_EQ(LeastChange(matrix, {1}, {}).solve({Rational(1)}, {1, 2}), Vector{2});
  EXPECT_EQ(LeastChange(matrix, {1}, {}).approximate({1.0}, {1.0, 2.0}).residual.high, 0.0);
}

TEST(LeastChange, RefusesWhatItCannotSolve) {
  const ConstraintMatrix matrix(3, {{{0, Rational(1)}, {1, Rational(1)}},
                                    {{2, Rational(1)}},
                                    {{0, Rational(2)}, {1, Rational(2)}, {2, Rational(1)}}});
  EXPECT_THROW(LeastChange(matrix, {0, 1}, {0}, {Rational(1)}), PreconditionError);
  EXPECT_THROW(LeastChange(matrix, {0, 1}, {0}, {Rational(1), Rational(0)}), PreconditionError);
  EXPECT_THROW(LeastChange(matrix, {0, 0}, {0}), PreconditionError);
  EXPECT_THROW(LeastChange(matrix, {0, 3}, {0}), PreconditionError);
  EXPECT_THROW(LeastChange(matrix, {0, 1}, {1}), PreconditionError);  // row 1 is not on them
  const LeastChange dependent(matrix, {0, 1}, {0, 2});
  EXPECT_THROW(static_cast<void>(dependent.solve({1, 1, 1}, {0, 0, 0})), PreconditionError);
}

// Two rows that doubles cannot tell apart: only elimination helps, where it is allowed.
TEST(LeastChange, WithinALimit) {
  const Rational near = Rational(1) + Rational(1).scaled_by_power_of_two(-80);
  const ConstraintMatrix matrix(3, {{{0, 1}, {1, 1}}, {{0, 1}, {1, near}, {2, 1}}});
  const LeastChange least(matrix, {0, 1}, {0, 1});
  const std::vector<Rational> right{1, 2}, values{0, 0, 0};
  EXPECT_EQ(least.solve_within(1, right, values), std::nullopt);
  const auto solved = least.solve_within(2, right, values);
  ASSERT_TRUE(solved);
  EXPECT_EQ(*solved, least.solve(right, values));
  EXPECT_EQ((*solved)[1], Rational(1).scaled_by_power_of_two(80));
  const LeastChange easy(matrix, {0, 1}, {0});
  EXPECT_EQ(easy.solve_within(1, right, values), easy.solve(right, values));
}

TEST(LeastChange, DigitsAreBoundedFromAbove) {
  const ConstraintMatrix matrix(4, {{{0, 3}, {1, 4}}, {{1, 1}, {2, 5}}});
  const LeastChange least(matrix, {0, 1, 2, 3}, {0, 1});
  EXPECT_EQ(least.most_digits().longest, 10);
  EXPECT_EQ(least.most_digits().together,
            3 * 10);  // 25 and 26 need five digits each; three parameters
  unsigned long bits = 0;
  for (const Rational& value : least.solve({1, 1}, {0, 0, 0, 0}))
    bits += value.denominator().bits();
  EXPECT_LE(static_cast<double>(bits), least.most_digits().together);
}

}  // namespace
}  // namespace isochor
