// Dense matrices of integers of any size.
//
// A value type: row-major Integers, with FLINT's algorithms behind it. Any of the two sizes may be
// zero; a product over nothing is zero, the determinant of the 0 x 0 matrix is 1.
//
// Laws (tests/exact/integer_matrix_test.cpp):
//  (1) ring:       (A B) C == A (B C), transpose(A B) == transpose(B) transpose(A)
//  (2) determinant: determinant(A B) == determinant(A) determinant(B); nonzero iff rank(A) == n
//  (3) Hermite:    transform A == form, |determinant(transform)| == 1
//  (4) LLL:        the rows of lll_reduced() span the same lattice as those of the matrix
//  (5) kernel:     A kernel^T == 0, kernel has columns() - rank() rows, and each integer x with
//                  A x == 0 is an integer combination of them (the lattice is saturated)
// Not a law: rank() is fast. On sparse matrices of deficient rank FLINT's elimination is slower
// than a fraction-free one that pivots on small entries.
#pragma once

#include <cstddef>
#include <vector>

#include "isochor/exact/integer.h"

namespace isochor {

struct HermiteForm;

class IntegerMatrix {
 public:
  // 0 x 0.
  IntegerMatrix() = default;
  // Zeros. PreconditionError when a size is negative.
  IntegerMatrix(int rows, int columns);
  // PreconditionError unless there are rows x columns entries (row-major).
  IntegerMatrix(int rows, int columns, std::vector<Integer> entries);
  static IntegerMatrix identity(int size);

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  // Unchecked.
  const Integer& at(int i, int j) const { return entries_[index(i, j)]; }
  Integer& at(int i, int j) { return entries_[index(i, j)]; }
  void set(int i, int j, Integer value) { entries_[index(i, j)] = std::move(value); }

  friend IntegerMatrix operator*(const IntegerMatrix& a, const IntegerMatrix& b);
  IntegerMatrix transpose() const;
  // Over the rationals.
  int rank() const;
  // PreconditionError when the matrix is not square.
  Integer determinant() const;
  // The binary digits of the largest entry; 0 for zeros.
  unsigned long max_bits() const;
  bool is_zero() const;

  // The row-style Hermite normal form: upper echelon, pivots positive, entries above a pivot
  // between 0 and the pivot; rows of zeros last. Slow beyond about fifty rows: the transform's
  // entries grow.
  HermiteForm hermite_form() const;
  // A basis of short, nearly orthogonal rows (Lenstra-Lenstra-Lovasz, delta 0.99) of the lattice
  // that the rows span; as many rows as the rank.
  IntegerMatrix lll_reduced() const;
  // An LLL-reduced basis, as rows, of the lattice {x in Z^columns : A x = 0}.
  IntegerMatrix kernel_lattice() const;

  friend bool operator==(const IntegerMatrix& a, const IntegerMatrix& b);
  friend bool operator!=(const IntegerMatrix& a, const IntegerMatrix& b) { return !(a == b); }

 private:
  size_t index(int i, int j) const {
    return static_cast<size_t>(i) * static_cast<size_t>(columns_) + static_cast<size_t>(j);
  }

  int rows_ = 0;
  int columns_ = 0;
  std::vector<Integer> entries_;
};

// PreconditionError unless a.columns() == b.rows().
IntegerMatrix operator*(const IntegerMatrix& a, const IntegerMatrix& b);
bool operator==(const IntegerMatrix& a, const IntegerMatrix& b);

struct HermiteForm {
  IntegerMatrix form;
  IntegerMatrix transform;  // unimodular; transform * given == form
};

}  // namespace isochor
