#include "isochor/exact/rational_matrix.h"

#include <flint/flint.h>
#include <flint/fmpq.h>
#include <flint/fmpq_mat.h>

#include <algorithm>

#include "isochor/base/error.h"

namespace isochor {
namespace {

static_assert(sizeof(Rational) == sizeof(fmpq), "an array of Rationals is an array of fmpq");

// FLINT's view of entries that a RationalMatrix owns, for reading only.
class View {
 public:
  View(const RationalMatrix& matrix, const std::vector<Rational>& entries)
      : rows_(static_cast<size_t>(matrix.rows())) {
    auto* first = const_cast<fmpq*>(reinterpret_cast<const fmpq*>(entries.data()));
    for (size_t i = 0; i < rows_.size(); ++i) rows_[i] = first + i * matrix.columns();
    words_->entries = first;
    words_->r = matrix.rows();
    words_->c = matrix.columns();
    words_->rows = rows_.data();
  }
  View(const View&) = delete;
  View& operator=(const View&) = delete;
  operator const fmpq_mat_struct*() const { return words_; }  // NOLINT: what fmpq_mat_t decays to

 private:
  std::vector<fmpq*> rows_;
  fmpq_mat_t words_;
};

// A matrix that FLINT owns and may write to.
class Scratch {
 public:
  Scratch(int rows, int columns) { fmpq_mat_init(words_, rows, columns); }
  ~Scratch() { fmpq_mat_clear(words_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  fmpq_mat_struct* words() { return words_; }

  RationalMatrix take() {
    RationalMatrix result(static_cast<int>(fmpq_mat_nrows(words_)),
                          static_cast<int>(fmpq_mat_ncols(words_)));
    for (int i = 0; i < result.rows(); ++i) {
      for (int j = 0; j < result.columns(); ++j) {
        fmpq_swap(reinterpret_cast<fmpq*>(&result.at(i, j)), fmpq_mat_entry(words_, i, j));
      }
    }
    return result;
  }

 private:
  fmpq_mat_t words_;
};

}  // namespace

RationalMatrix::RationalMatrix(int rows, int columns) : rows_(rows), columns_(columns) {
  ISOCHOR_REQUIRE(rows >= 0 && columns >= 0, rows, columns);
  entries_.resize(static_cast<size_t>(rows) * static_cast<size_t>(columns));
}

RationalMatrix::RationalMatrix(int rows, int columns, std::vector<Rational> entries)
    : rows_(rows), columns_(columns), entries_(std::move(entries)) {
  ISOCHOR_REQUIRE(rows >= 0 && columns >= 0, rows, columns);
  ISOCHOR_REQUIRE(entries_.size() == static_cast<size_t>(rows) * static_cast<size_t>(columns),
                  entries_.size(), rows, columns);
}

RationalMatrix::RationalMatrix(const IntegerMatrix& matrix)
    : RationalMatrix(matrix.rows(), matrix.columns()) {
  for (int i = 0; i < rows_; ++i) {
    for (int j = 0; j < columns_; ++j) set(i, j, Rational(matrix.at(i, j)));
  }
}

RationalMatrix RationalMatrix::identity(int size) { return IntegerMatrix::identity(size); }

RationalMatrix& RationalMatrix::operator+=(const RationalMatrix& b) {
  ISOCHOR_REQUIRE(rows_ == b.rows_ && columns_ == b.columns_, rows_, columns_, b.rows_, b.columns_);
  for (size_t k = 0; k < entries_.size(); ++k) entries_[k] += b.entries_[k];
  return *this;
}

RationalMatrix& RationalMatrix::operator-=(const RationalMatrix& b) {
  ISOCHOR_REQUIRE(rows_ == b.rows_ && columns_ == b.columns_, rows_, columns_, b.rows_, b.columns_);
  for (size_t k = 0; k < entries_.size(); ++k) entries_[k] -= b.entries_[k];
  return *this;
}

RationalMatrix operator*(const RationalMatrix& a, const RationalMatrix& b) {
  ISOCHOR_REQUIRE(a.columns() == b.rows(), a.columns(), b.rows());
  Scratch product(a.rows(), b.columns());
  if (a.columns() > 0 && a.rows() > 0 && b.columns() > 0) {
    fmpq_mat_mul(product.words(), View(a, a.entries_), View(b, b.entries_));
  }
  return product.take();
}

RationalMatrix RationalMatrix::transpose() const {
  RationalMatrix result(columns_, rows_);
  for (int i = 0; i < rows_; ++i) {
    for (int j = 0; j < columns_; ++j) result.set(j, i, at(i, j));
  }
  return result;
}

bool RationalMatrix::is_zero() const {
  return std::all_of(entries_.begin(), entries_.end(),
                     [](const Rational& entry) { return entry.is_zero(); });
}

std::optional<RationalMatrix> RationalMatrix::inverse() const {
  return solve(*this, identity(rows_));
}

EchelonForm RationalMatrix::reduced_row_echelon() const {
  EchelonForm result{*this, {}};
  if (entries_.empty()) return result;
  Scratch form(rows_, columns_);
  const auto rank = static_cast<int>(fmpq_mat_rref(form.words(), View(*this, entries_)));
  result.form = form.take();
  for (int i = 0, j = 0; i < rank; ++i, ++j) {
    while (result.form.at(i, j).is_zero()) ++j;
    result.pivot_columns.push_back(j);
  }
  return result;
}

std::optional<RationalMatrix> solve(const RationalMatrix& a, const RationalMatrix& b) {
  ISOCHOR_REQUIRE(a.rows() == a.columns(), a.rows(), a.columns());
  ISOCHOR_REQUIRE(a.rows() == b.rows(), a.rows(), b.rows());
  if (a.rows() == 0) return RationalMatrix(0, b.columns());
  // FLINT says nothing about A when there is no right-hand side.
  const bool nothing_asked = b.columns() == 0;
  const RationalMatrix probe = nothing_asked ? RationalMatrix(a.rows(), 1) : RationalMatrix();
  const RationalMatrix& right = nothing_asked ? probe : b;
  Scratch solution(a.rows(), right.columns());
  if (fmpq_mat_solve(solution.words(), View(a, a.entries_), View(right, right.entries_)) == 0) {
    return std::nullopt;
  }
  return nothing_asked ? RationalMatrix(a.rows(), 0) : solution.take();
}

bool operator==(const RationalMatrix& a, const RationalMatrix& b) {
  return a.rows_ == b.rows_ && a.columns_ == b.columns_ && a.entries_ == b.entries_;
}

}  // namespace isochor
