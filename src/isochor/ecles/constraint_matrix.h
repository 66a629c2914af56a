// The coefficients of linear constraints on numbered parameters, exact and sparse.
//
// Symbols: R is the matrix, m constraints (rows) by n parameters (columns), of integers. A row
// given in rationals is stored as scale(i) times itself: the smallest positive multiple whose
// entries are integers without a common factor. Right-hand sides live beside the matrix, never in
// it, so that one matrix serves every edit (Rodrigues 2017, 2.1).
//
// Laws:
//  (1) stored row i == scale(i) * given row i, scale(i) > 0;
//  (2) a row's terms ascend by parameter, none is zero;
//  (3) column(j) lists exactly the rows with a nonzero coefficient on j, ascending.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "isochor/exact/integer.h"
#include "isochor/exact/rational.h"

namespace isochor {

// A linear form as users give it: any order; repeated parameters add up.
using RationalTerms = std::vector<std::pair<int, Rational>>;

struct ConstraintTerm {
  int parameter = 0;
  Integer coefficient;
};

// A view of consecutive elements of an array that outlives it.
template <typename T>
class ArrayView {
 public:
  ArrayView(const T* begin, const T* end) : begin_(begin), end_(end) {}
  const T* begin() const { return begin_; }
  const T* end() const { return end_; }
  size_t size() const { return static_cast<size_t>(end_ - begin_); }
  bool empty() const { return begin_ == end_; }
  const T& operator[](size_t i) const { return begin_[i]; }

 private:
  const T* begin_;
  const T* end_;
};

class ConstraintMatrix {
 public:
  // PreconditionError when a parameter is not in [0, parameters). Rows of zeros are allowed.
  // Cost O(nonzeros log) integer operations.
  ConstraintMatrix(int parameters, const std::vector<RationalTerms>& rows);

  int rows() const { return static_cast<int>(row_begin_.size()) - 1; }
  int parameters() const { return static_cast<int>(column_begin_.size()) - 1; }
  size_t nonzeros() const { return terms_.size(); }

  ArrayView<ConstraintTerm> row(int i) const {
    return {terms_.data() + row_begin_[static_cast<size_t>(i)],
            terms_.data() + row_begin_[static_cast<size_t>(i) + 1]};
  }
  // The rows that involve parameter j.
  ArrayView<int> column(int j) const {
    return {column_rows_.data() + column_begin_[static_cast<size_t>(j)],
            column_rows_.data() + column_begin_[static_cast<size_t>(j) + 1]};
  }
  const Rational& scale(int i) const { return scales_[static_cast<size_t>(i)]; }

 private:
  std::vector<size_t> row_begin_, column_begin_;
  std::vector<ConstraintTerm> terms_;
  std::vector<int> column_rows_;
  std::vector<Rational> scales_;
};

}  // namespace isochor
