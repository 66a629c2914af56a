// Random systems for the tests of the exact engine, and the two forms they are needed in.
#pragma once

#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include "ecles/rational_elimination.h"
#include "isochor/exact/integer_matrix.h"
#include "isochor/exact/rational_matrix.h"

namespace isochor::test {

inline IntegerMatrix integers(const std::vector<std::vector<long>>& rows, int columns) {
  IntegerMatrix result(static_cast<int>(rows.size()), columns);
  for (int i = 0; i < result.rows(); ++i) {
    for (int j = 0; j < columns; ++j) {
      result.set(i, j, rows[static_cast<size_t>(i)][static_cast<size_t>(j)]);
    }
  }
  return result;
}

inline IntegerMatrix integers(const std::vector<std::vector<long>>& rows) {
  return integers(rows, static_cast<int>(rows.at(0).size()));
}

inline Table table_of(const RationalMatrix& matrix) {
  Table result(static_cast<size_t>(matrix.rows()),
               std::vector<Rational>(static_cast<size_t>(matrix.columns())));
  for (int i = 0; i < matrix.rows(); ++i) {
    for (int j = 0; j < matrix.columns(); ++j) {
      result[static_cast<size_t>(i)][static_cast<size_t>(j)] = matrix.at(i, j);
    }
  }
  return result;
}

inline RationalMatrix column_of(const std::vector<Rational>& values) {
  return RationalMatrix(static_cast<int>(values.size()), 1, values);
}

struct RandomMatrix {
  int rows = 0;
  int columns = 0;
  int rank = -1;         // a bound, by a product through that many columns; -1: none
  double density = 1.0;  // of nonzero entries
  int bits = 10;         // of the entries; of the factors' when the rank is bounded
};

inline Integer random_integer(std::mt19937_64& random, int bits) {
  Integer result;
  for (int left = bits; left > 0; left -= 32) {
    const int digits = left < 32 ? left : 32;
    result = result.shifted(static_cast<unsigned long>(digits));
    result += static_cast<long>(random() >> (64 - digits));
  }
  return random() % 2 == 0 ? result : -result;
}

inline IntegerMatrix random_full(std::mt19937_64& random, int rows, int columns, double density,
                                 int bits) {
  IntegerMatrix result(rows, columns);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      if (chance(random) < density) result.set(i, j, random_integer(random, bits));
    }
  }
  return result;
}

inline IntegerMatrix random_matrix(std::mt19937_64& random, const RandomMatrix& wanted) {
  if (wanted.rank < 0) {
    return random_full(random, wanted.rows, wanted.columns, wanted.density, wanted.bits);
  }
  return random_full(random, wanted.rows, wanted.rank, wanted.density, wanted.bits) *
         random_full(random, wanted.rank, wanted.columns, wanted.density, wanted.bits);
}

}  // namespace isochor::test
