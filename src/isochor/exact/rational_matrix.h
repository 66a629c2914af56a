// Dense matrices of rationals, and exact solutions of linear systems.
//
// A value type: row-major Rationals, with FLINT's algorithms behind it. Any of the two sizes may be
// zero; a product over nothing is zero.
//
// Laws (tests/exact/rational_matrix_test.cpp):
//  (1) ring:     (A B) C == A (B C), A (B + C) == A B + A C
//  (2) inverse:  A inverse(A) == inverse(A) A == 1; there is none exactly when rank(A) < n
//  (3) solve:    A solve(A, B) == B, and there is no solution exactly when A is singular
//  (4) echelon:  the form has the matrix's row space, leading ones, zeros above and below them
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "isochor/exact/integer_matrix.h"
#include "isochor/exact/rational.h"

namespace isochor {

struct EchelonForm;

class RationalMatrix {
 public:
  // 0 x 0.
  RationalMatrix() = default;
  // Zeros. PreconditionError when a size is negative.
  RationalMatrix(int rows, int columns);
  // PreconditionError unless there are rows x columns entries (row-major).
  RationalMatrix(int rows, int columns, std::vector<Rational> entries);
  RationalMatrix(const IntegerMatrix& matrix);  // NOLINT: every integer matrix is a rational one
  static RationalMatrix identity(int size);

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  // Unchecked.
  const Rational& at(int i, int j) const { return entries_[index(i, j)]; }
  Rational& at(int i, int j) { return entries_[index(i, j)]; }
  void set(int i, int j, Rational value) { entries_[index(i, j)] = std::move(value); }

  // Sizes must agree: PreconditionError.
  RationalMatrix& operator+=(const RationalMatrix& b);
  RationalMatrix& operator-=(const RationalMatrix& b);
  friend RationalMatrix operator+(RationalMatrix a, const RationalMatrix& b) {
    return std::move(a += b);
  }
  friend RationalMatrix operator-(RationalMatrix a, const RationalMatrix& b) {
    return std::move(a -= b);
  }
  friend RationalMatrix operator*(const RationalMatrix& a, const RationalMatrix& b);
  RationalMatrix transpose() const;
  bool is_zero() const;

  // Nothing when singular; PreconditionError when not square.
  std::optional<RationalMatrix> inverse() const;
  EchelonForm reduced_row_echelon() const;

  friend std::optional<RationalMatrix> solve(const RationalMatrix& a, const RationalMatrix& b);
  friend bool operator==(const RationalMatrix& a, const RationalMatrix& b);
  friend bool operator!=(const RationalMatrix& a, const RationalMatrix& b) { return !(a == b); }

 private:
  size_t index(int i, int j) const {
    return static_cast<size_t>(i) * static_cast<size_t>(columns_) + static_cast<size_t>(j);
  }

  int rows_ = 0;
  int columns_ = 0;
  std::vector<Rational> entries_;
};

struct EchelonForm {
  RationalMatrix form;             // rows of zeros last
  std::vector<int> pivot_columns;  // of row 0, 1, ...; their number is the rank
};

// PreconditionError unless a.columns() == b.rows().
RationalMatrix operator*(const RationalMatrix& a, const RationalMatrix& b);
bool operator==(const RationalMatrix& a, const RationalMatrix& b);

// X with A X == B, by p-adic lifting or fraction-free elimination, whichever suits the size;
// nothing when A is singular. PreconditionError when A is not square or B has other rows than A.
std::optional<RationalMatrix> solve(const RationalMatrix& a, const RationalMatrix& b);

}  // namespace isochor
