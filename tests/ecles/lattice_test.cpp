#include "isochor/ecles/lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isochor/base/error.h"
#include "isochor/exact/rational_matrix.h"

namespace isochor::internal {
namespace {

constexpr int kSeed = 20170411;

IntegerMatrix random_matrix(int m, int n, long size, double density, std::mt19937& random) {
  std::uniform_int_distribution<long> entry(-size, size);
  std::bernoulli_distribution present(density);
  for (;;) {
    IntegerMatrix a(m, n);
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < n; ++j)
        if (present(random)) a.set(i, j, entry(random));
    if (a.rank() == m) return a;
  }
}

IntegerMatrix rows_of(const IntegerVectors& vectors, int columns) {
  IntegerMatrix result(static_cast<int>(vectors.size()), columns);
  for (int i = 0; i < result.rows(); ++i)
    for (int j = 0; j < columns; ++j)
      result.set(i, j, vectors[static_cast<size_t>(i)][static_cast<size_t>(j)]);
  return result;
}

std::vector<Integer> ones(int n) {
  return std::vector<Integer>(static_cast<size_t>(n), Integer(1));
}

// The row lattices are equal when their Hermite forms are.
void expect_same_lattice(const IntegerMatrix& a, const IntegerMatrix& b) {
  EXPECT_EQ(a.hermite_form().form, b.hermite_form().form);
}

TEST(SolutionLattice, KernelSpansEveryIntegerSolution) {
  std::mt19937 random(kSeed);
  for (const auto& [m, n] : {std::pair{1, 2}, {1, 6}, {4, 4}, {5, 9}, {12, 20}, {0, 3}})
    for (const long size : {2L, 4095L, 1L << 45}) {
      const IntegerMatrix a = random_matrix(m, n, size, 0.6, random);
      const SolutionLattice lattice(a, ones(n));
      const IntegerMatrix kernel = rows_of(lattice.kernel(), n);
      EXPECT_TRUE((a * kernel.transpose()).is_zero());
      if (m < n) expect_same_lattice(kernel, a.kernel_lattice());  // another algorithm
      // The index is that of the columns' lattice in Z^m: the product of the Hermite pivots.
      const IntegerMatrix form = a.transpose().hermite_form().form;
      Integer index = 1;
      for (int i = 0; i < m; ++i) index *= form.at(i, i);
      EXPECT_EQ(lattice.index(), index);
    }
}

TEST(SolutionLattice, MultipliersKeepASublattice) {
  // x0 + x1 = 0 with x0 even and x1 a multiple of 3: multiples of (6, -6).
  const SolutionLattice lattice(IntegerMatrix(1, 2, {1, 1}), {2, 3});
  ASSERT_EQ(lattice.kernel().size(), 1u);
  EXPECT_EQ(lattice.kernel()[0][0].abs(), Integer(6));
  EXPECT_EQ(lattice.kernel()[0][0], -lattice.kernel()[0][1]);
  EXPECT_EQ(lattice.index(), Integer(1));
}

struct Trial {
  std::vector<Wide> s;
  std::vector<double> target;
};

// A right side that has solutions, and a target next to one that solves it in reals.
Trial random_trial(const IntegerMatrix& a, const SolutionLattice& lattice, long reach,
                   std::mt19937& random) {
  std::uniform_int_distribution<long> number(-reach, reach);
  std::uniform_real_distribution<double> share(-20.0, 20.0);
  Trial trial;
  std::vector<long> x;
  for (int j = 0; j < a.columns(); ++j) x.push_back(number(random));
  trial.target.assign(x.begin(), x.end());
  for (const auto& vector : lattice.kernel()) {
    const double t = share(random);
    for (size_t j = 0; j < x.size(); ++j) trial.target[j] += t * vector[j].to_double();
  }
  for (int i = 0; i < a.rows(); ++i) {
    Wide sum = 0;
    for (int j = 0; j < a.columns(); ++j)
      if (!add_product(sum, *a.at(i, j).to_long(), x[static_cast<size_t>(j)])) std::abort();
    trial.s.push_back(sum);
  }
  return trial;
}

TEST(SolutionLattice, NearestIsExactAndWithinTheBound) {
  std::mt19937 random(kSeed + 1);
  double closest_to_bound = 0.0;
  for (int round = 0; round < 200; ++round) {
    const int m = round % 7, n = m + 1 + round % 5;
    const long size = round % 2 == 0 && m < 4 ? 4095 : 7;  // kernels grow with both
    const IntegerMatrix a = random_matrix(m, n, size, 0.7, random);
    const SolutionLattice lattice(a, ones(n));
    ASSERT_TRUE(lattice.fits());
    const std::vector<double> bound = lattice.bound();
    const Trial trial = random_trial(a, lattice, 1L << 40, random);
    std::vector<Wide> x;
    ASSERT_TRUE(lattice.nearest(trial.s, trial.target, x));
    for (int i = 0; i < m; ++i) {
      Wide sum = 0;
      for (int j = 0; j < n; ++j)
        ASSERT_TRUE(add_product(sum, *a.at(i, j).to_long(), x[static_cast<size_t>(j)]));
      EXPECT_TRUE(sum == trial.s[static_cast<size_t>(i)]);
    }
    for (size_t j = 0; j < x.size(); ++j) {
      const double off = std::fabs(static_cast<double>(x[j]) - trial.target[j]);
      EXPECT_LE(off, bound[j] + 1e-2) << round;  // the target was rounded at 2^40
      if (bound[j] > 10) closest_to_bound = std::max(closest_to_bound, off / bound[j]);
    }
  }
  EXPECT_GT(closest_to_bound, 0.5);  // the bound is of the right size
}

TEST(SolutionLattice, ObstaclesProveThatThereIsNoSolution) {
  std::mt19937 random(kSeed + 2);
  std::uniform_int_distribution<long> number(-100, 100);
  int obstacles = 0;
  for (int round = 0; round < 200; ++round) {
    const int m = 1 + round % 5, n = m + round % 3;
    const IntegerMatrix a = random_matrix(m, n, 6, 0.8, random);
    const SolutionLattice lattice(a, ones(n));
    std::vector<Integer> s;
    std::vector<Wide> words;
    for (int i = 0; i < m; ++i) {
      words.push_back(number(random));
      s.emplace_back(static_cast<long>(words.back()));
    }
    std::vector<Wide> x;
    const bool solved = lattice.nearest(words, std::vector<double>(static_cast<size_t>(n)), x);
    const auto obstacle = lattice.obstacle(s);
    ASSERT_EQ(solved, !obstacle);
    if (!obstacle) continue;
    ++obstacles;
    Rational value;
    for (int i = 0; i < m; ++i)
      value += obstacle->multipliers[static_cast<size_t>(i)] * Rational(s[static_cast<size_t>(i)]);
    EXPECT_EQ(value, obstacle->value);
    EXPECT_NE(value.denominator(), Integer(1));
    for (int j = 0; j < n; ++j) {
      Rational entry;
      for (int i = 0; i < m; ++i)
        entry += obstacle->multipliers[static_cast<size_t>(i)] * Rational(a.at(i, j));
      EXPECT_EQ(entry.denominator(), Integer(1));
    }
  }
  EXPECT_GT(obstacles, 50);
  EXPECT_LT(obstacles, 190);
}

TEST(SolutionLattice, NumbersBeyondWordsAreSaid) {
  const Integer huge = Integer(1).shifted(100);
  const SolutionLattice lattice(IntegerMatrix(1, 2, {huge, huge + Integer(1)}), ones(2));
  EXPECT_FALSE(lattice.fits());
  EXPECT_EQ(lattice.index(), Integer(1));
  // Within words, but what is asked of it leaves 128 bits.
  const SolutionLattice small(IntegerMatrix(1, 2, {3, 5}), ones(2));
  std::vector<Wide> x;
  EXPECT_FALSE(small.nearest({Wide{1} << 126}, {0.0, 0.0}, x));
  EXPECT_FALSE(small.nearest({Wide{1}}, {std::nan(""), 0.0}, x));
}

TEST(SolutionLattice, RefusesDependentRows) {
  EXPECT_THROW(SolutionLattice(IntegerMatrix(2, 2, {1, 2, 2, 4}), ones(2)), PreconditionError);
  EXPECT_THROW(SolutionLattice(IntegerMatrix(1, 2, {1, 2}), {1, 0}), PreconditionError);
}

TEST(ReduceBasis, FindsShortVectorsOfLongOnes) {
  IntegerVectors basis = {{1, 0, 1000003}, {0, 1, 1414213}, {0, 0, 3000000}};
  const IntegerMatrix before = rows_of(basis, 3);
  reduce_basis(basis);
  expect_same_lattice(rows_of(basis, 3), before);
  // The volume is 3e6: vectors near its cube root, 144.
  for (const auto& vector : basis)
    for (const Integer& entry : vector) EXPECT_LT(entry.abs(), Integer(1000));
  // Entries too long for the doubles take the exact way.
  IntegerVectors longer = {{1, Integer(1).shifted(200)}, {0, Integer(1).shifted(90)}};
  const IntegerMatrix long_before = rows_of(longer, 2);
  reduce_basis(longer);
  expect_same_lattice(rows_of(longer, 2), long_before);
}

}  // namespace
}  // namespace isochor::internal
