#include "isochor/exact/integer_matrix.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "isochor/base/error.h"
#include "isochor/exact/rational.h"

namespace isochor {
namespace {

using Rows = std::vector<std::vector<Rational>>;

IntegerMatrix from(const std::vector<std::vector<long>>& rows) {
  IntegerMatrix result(static_cast<int>(rows.size()),
                       rows.empty() ? 0 : static_cast<int>(rows.front().size()));
  for (int i = 0; i < result.rows(); ++i) {
    for (int j = 0; j < result.columns(); ++j) {
      result.set(i, j, rows[static_cast<size_t>(i)][static_cast<size_t>(j)]);
    }
  }
  return result;
}

IntegerMatrix random_matrix(std::mt19937_64& random, int rows, int columns, long size) {
  std::uniform_int_distribution<long> entry(-size, size);
  IntegerMatrix result(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) result.set(i, j, entry(random));
  }
  return result;
}

// The second method: one multiplication at a time.
IntegerMatrix naive_product(const IntegerMatrix& a, const IntegerMatrix& b) {
  IntegerMatrix result(a.rows(), b.columns());
  for (int i = 0; i < a.rows(); ++i) {
    for (int j = 0; j < b.columns(); ++j) {
      for (int k = 0; k < a.columns(); ++k) {
        result.at(i, j) += a.at(i, k) * b.at(k, j);
      }
    }
  }
  return result;
}

Rational dot(const std::vector<Rational>& a, const std::vector<Rational>& b) {
  Rational sum;
  for (size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

Rows rational_rows(const IntegerMatrix& matrix) {
  Rows result(static_cast<size_t>(matrix.rows()));
  for (int i = 0; i < matrix.rows(); ++i) {
    for (int j = 0; j < matrix.columns(); ++j) {
      result[static_cast<size_t>(i)].emplace_back(matrix.at(i, j));
    }
  }
  return result;
}

// The rows made orthogonal to those before them; coefficients[i][k] of earlier row k.
struct Orthogonal {
  Rows rows;
  Rows coefficients;
};
Orthogonal orthogonalised(const IntegerMatrix& matrix) {
  Orthogonal result{rational_rows(matrix), Rows(static_cast<size_t>(matrix.rows()))};
  for (size_t i = 0; i < result.rows.size(); ++i) {
    const std::vector<Rational> given = result.rows[i];
    for (size_t k = 0; k < i; ++k) {
      const std::vector<Rational>& earlier = result.rows[k];
      const Rational length = dot(earlier, earlier);
      const Rational factor = length.is_zero() ? Rational() : dot(given, earlier) / length;
      result.coefficients[i].push_back(factor);
      for (size_t j = 0; j < given.size(); ++j) result.rows[i][j] -= factor * earlier[j];
    }
  }
  return result;
}

int naive_rank(const IntegerMatrix& matrix) {
  int rank = 0;
  for (const auto& row : orthogonalised(matrix).rows) rank += dot(row, row).is_zero() ? 0 : 1;
  return rank;
}

// By expansion along the first row.
Integer naive_determinant(const IntegerMatrix& matrix) {
  if (matrix.rows() == 0) return 1;
  Integer sum;
  for (int column = 0; column < matrix.columns(); ++column) {
    IntegerMatrix minor(matrix.rows() - 1, matrix.columns() - 1);
    for (int i = 0; i < minor.rows(); ++i) {
      for (int j = 0; j < minor.columns(); ++j) {
        minor.set(i, j, matrix.at(i + 1, j < column ? j : j + 1));
      }
    }
    const Integer term = matrix.at(0, column) * naive_determinant(minor);
    sum += column % 2 == 0 ? term : -term;
  }
  return sum;
}

IntegerMatrix without_zero_rows(const IntegerMatrix& matrix) {
  std::vector<Integer> entries;
  int kept = 0;
  for (int i = 0; i < matrix.rows(); ++i) {
    bool zero = true;
    for (int j = 0; j < matrix.columns(); ++j) zero = zero && matrix.at(i, j).is_zero();
    if (zero) continue;
    ++kept;
    for (int j = 0; j < matrix.columns(); ++j) entries.push_back(matrix.at(i, j));
  }
  return IntegerMatrix(kept, matrix.columns(), entries);
}

TEST(IntegerMatrix, RingLaws) {
  std::mt19937_64 random(21);
  for (int round = 0; round < 30; ++round) {
    const int size = round % 6;
    const IntegerMatrix a = random_matrix(random, size, 4, 1L << (2 * round));
    const IntegerMatrix b = random_matrix(random, 4, 3, 1000);
    const IntegerMatrix c = random_matrix(random, 3, size, 1000);
    EXPECT_EQ(a * b, naive_product(a, b));
    EXPECT_EQ((a * b) * c, a * (b * c));
    EXPECT_EQ((a * b).transpose(), b.transpose() * a.transpose());
    EXPECT_EQ(IntegerMatrix::identity(size) * a, a);
  }
}

TEST(IntegerMatrix, DeterminantLaws) {
  std::mt19937_64 random(22);
  for (int round = 0; round < 24; ++round) {
    const int size = round % 6;
    const IntegerMatrix a = random_matrix(random, size, size, round < 12 ? 2 : 1L << 60);
    const IntegerMatrix b = random_matrix(random, size, size, 9);
    EXPECT_EQ(a.determinant(), naive_determinant(a));
    EXPECT_EQ((a * b).determinant(), a.determinant() * b.determinant());
    EXPECT_EQ(!a.determinant().is_zero(), a.rank() == size);
  }
  EXPECT_THROW((void)IntegerMatrix(2, 3).determinant(), PreconditionError);
}

TEST(IntegerMatrix, RankOfProducts) {
  std::mt19937_64 random(23);
  for (int rank = 0; rank <= 5; ++rank) {
    const IntegerMatrix a = random_matrix(random, 6, rank, 50) * random_matrix(random, rank, 5, 50);
    EXPECT_EQ(a.rank(), naive_rank(a));
    EXPECT_EQ(a.transpose().rank(), a.rank());
    EXPECT_LE(a.rank(), rank);
  }
}

TEST(IntegerMatrix, HermiteFormLaws) {
  std::mt19937_64 random(24);
  for (int round = 0; round < 20; ++round) {
    const int inner = round % 5;
    const IntegerMatrix a = random_matrix(random, 5, inner, 9) * random_matrix(random, inner, 4, 9);
    const HermiteForm hermite = a.hermite_form();
    EXPECT_EQ(hermite.transform * a, hermite.form);
    EXPECT_EQ(hermite.transform.determinant().abs(), 1);
    int previous = -1;
    for (int i = 0; i < hermite.form.rows(); ++i) {
      int pivot = 0;
      while (pivot < 4 && hermite.form.at(i, pivot).is_zero()) ++pivot;
      EXPECT_TRUE(pivot > previous || pivot == 4);
      previous = pivot;
      if (pivot == 4) continue;
      EXPECT_EQ(hermite.form.at(i, pivot).sign(), 1);
      for (int above = 0; above < i; ++above) {
        EXPECT_GE(hermite.form.at(above, pivot).sign(), 0);
        EXPECT_LT(hermite.form.at(above, pivot), hermite.form.at(i, pivot));
      }
    }
  }
}

TEST(IntegerMatrix, LatticeReductionLaws) {
  std::mt19937_64 random(25);
  const Rational eta(52, 100);
  const Rational delta(98, 100);
  for (int round = 0; round < 20; ++round) {
    const int inner = 1 + round % 5;
    const IntegerMatrix a =
        random_matrix(random, 5, inner, 300) * random_matrix(random, inner, 6, 300);
    const IntegerMatrix reduced = a.lll_reduced();
    EXPECT_EQ(reduced.rows(), a.rank());
    // The Hermite form of a lattice is unique.
    EXPECT_EQ(without_zero_rows(reduced.hermite_form().form),
              without_zero_rows(a.hermite_form().form));
    const Orthogonal basis = orthogonalised(reduced);
    for (size_t i = 1; i < basis.rows.size(); ++i) {
      for (const Rational& coefficient : basis.coefficients[i]) EXPECT_LE(coefficient.abs(), eta);
      const Rational along = basis.coefficients[i].back();
      const Rational before = dot(basis.rows[i - 1], basis.rows[i - 1]);
      EXPECT_GE(dot(basis.rows[i], basis.rows[i]), (delta - along * along) * before);
    }
  }
}

TEST(IntegerMatrix, KernelLatticeIsAllOfTheKernel) {
  // 6 x + 10 y + 15 z == 0.
  const IntegerMatrix a = from({{6, 10, 15}});
  const IntegerMatrix kernel = a.kernel_lattice();
  ASSERT_EQ(kernel.rows(), 2);
  EXPECT_TRUE((a * kernel.transpose()).is_zero());
  const auto minor = [&](int i, int j) {
    return kernel.at(0, i) * kernel.at(1, j) - kernel.at(0, j) * kernel.at(1, i);
  };
  // Saturated means that the minors have no common factor; here they are the coefficients.
  EXPECT_EQ(gcd(gcd(minor(1, 2), minor(0, 2)), minor(0, 1)), 1);
  EXPECT_EQ(minor(1, 2).abs(), 6);
  EXPECT_EQ(minor(0, 2).abs(), 10);
  EXPECT_EQ(minor(0, 1).abs(), 15);
}

TEST(IntegerMatrix, KernelLatticeLaws) {
  std::mt19937_64 random(26);
  for (int round = 0; round < 20; ++round) {
    const int rows = round % 5;
    const IntegerMatrix a = random_matrix(random, rows, 6, 30);
    const IntegerMatrix kernel = a.kernel_lattice();
    EXPECT_EQ(kernel.rows(), 6 - a.rank());
    EXPECT_EQ(kernel.columns(), 6);
    EXPECT_TRUE((a * kernel.transpose()).is_zero());
    // A lattice is saturated iff its basis extends to a unimodular matrix: the columns span Z^k.
    EXPECT_EQ(without_zero_rows(kernel.transpose().hermite_form().form),
              IntegerMatrix::identity(kernel.rows()));
  }
}

TEST(IntegerMatrix, NothingIsAMatrixToo) {
  for (const auto& [rows, columns] : {std::pair(0, 0), std::pair(0, 3), std::pair(3, 0)}) {
    const IntegerMatrix a(rows, columns);
    EXPECT_EQ(a.rank(), 0);
    EXPECT_EQ(a.max_bits(), 0u);
    EXPECT_EQ(a.transpose().rows(), columns);
    EXPECT_EQ(a * a.transpose(), IntegerMatrix(rows, rows));
    EXPECT_EQ(a.lll_reduced(), IntegerMatrix(0, columns));
    EXPECT_EQ(a.kernel_lattice().rows(), columns);
    EXPECT_EQ(a.hermite_form().transform, IntegerMatrix::identity(rows));
  }
  EXPECT_EQ(IntegerMatrix().determinant(), 1);
  EXPECT_EQ(IntegerMatrix(3, 2).kernel_lattice(), IntegerMatrix::identity(2));
}

TEST(IntegerMatrix, BitsCountTheLargestMagnitude) {
  EXPECT_EQ(from({{3, -8}, {0, 7}}).max_bits(), 4u);
  EXPECT_EQ(from({{0, 0}}).max_bits(), 0u);
  IntegerMatrix huge(1, 1);
  huge.set(0, 0, -Integer(1).shifted(500));
  EXPECT_EQ(huge.max_bits(), 501u);
}

TEST(IntegerMatrix, SizesMustFit) {
  EXPECT_THROW(IntegerMatrix(-1, 2), PreconditionError);
  EXPECT_THROW(IntegerMatrix(1, 2, {1}), PreconditionError);
  EXPECT_THROW(IntegerMatrix(1, 2) * IntegerMatrix(1, 2), PreconditionError);
}

TEST(IntegerMatrix, ValuesDoNotShareState) {
  IntegerMatrix a = from({{1, 2}, {3, 4}});
  IntegerMatrix copy = a;
  copy.at(0, 0) = 9;
  EXPECT_EQ(a.at(0, 0), 1);
  a = a * a;
  EXPECT_EQ(a, from({{7, 10}, {15, 22}}));
}

}  // namespace
}  // namespace isochor
