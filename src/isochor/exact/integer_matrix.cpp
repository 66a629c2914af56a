#include "isochor/exact/integer_matrix.h"

#include <flint/flint.h>
#include <flint/fmpz.h>
#include <flint/fmpz_lll.h>
#include <flint/fmpz_mat.h>

#include <algorithm>

#include "isochor/base/error.h"

namespace isochor {
namespace {

static_assert(sizeof(Integer) == sizeof(fmpz), "an array of Integers is an array of FLINT's fmpz");

// FLINT's view of entries that an IntegerMatrix owns: for reading only, because FLINT may swap the
// arrays of what it writes to.
class View {
 public:
  View(const IntegerMatrix& matrix, const std::vector<Integer>& entries)
      : rows_(static_cast<size_t>(matrix.rows())) {
    auto* first = const_cast<fmpz*>(reinterpret_cast<const fmpz*>(entries.data()));
    for (size_t i = 0; i < rows_.size(); ++i) rows_[i] = first + i * matrix.columns();
    words_->entries = first;
    words_->r = matrix.rows();
    words_->c = matrix.columns();
    words_->rows = rows_.data();
  }
  View(const View&) = delete;
  View& operator=(const View&) = delete;
  operator const fmpz_mat_struct*() const { return words_; }  // NOLINT: what fmpz_mat_t decays to

 private:
  std::vector<fmpz*> rows_;
  fmpz_mat_t words_;
};

// A matrix that FLINT owns and may write to.
class Scratch {
 public:
  Scratch(int rows, int columns) { fmpz_mat_init(words_, rows, columns); }
  ~Scratch() { fmpz_mat_clear(words_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  fmpz_mat_struct* words() { return words_; }

  // The rows [begin, end), moved out.
  IntegerMatrix take_rows(int begin, int end) {
    IntegerMatrix result(end - begin, static_cast<int>(fmpz_mat_ncols(words_)));
    for (int i = begin; i < end; ++i) {
      for (int j = 0; j < result.columns(); ++j) {
        fmpz_swap(reinterpret_cast<fmpz*>(&result.at(i - begin, j)), fmpz_mat_entry(words_, i, j));
      }
    }
    return result;
  }
  IntegerMatrix take() { return take_rows(0, static_cast<int>(fmpz_mat_nrows(words_))); }

 private:
  fmpz_mat_t words_;
};

int count_zero_rows(const IntegerMatrix& matrix) {
  int result = 0;
  for (int i = 0; i < matrix.rows(); ++i) {
    bool zero = true;
    for (int j = 0; j < matrix.columns() && zero; ++j) zero = matrix.at(i, j).is_zero();
    if (zero) ++result;
  }
  return result;
}

}  // namespace

IntegerMatrix::IntegerMatrix(int rows, int columns) : rows_(rows), columns_(columns) {
  ISOCHOR_REQUIRE(rows >= 0 && columns >= 0, rows, columns);
  entries_.resize(static_cast<size_t>(rows) * static_cast<size_t>(columns));
}

IntegerMatrix::IntegerMatrix(int rows, int columns, std::vector<Integer> entries)
    : rows_(rows), columns_(columns), entries_(std::move(entries)) {
  ISOCHOR_REQUIRE(rows >= 0 && columns >= 0, rows, columns);
  ISOCHOR_REQUIRE(entries_.size() == static_cast<size_t>(rows) * static_cast<size_t>(columns),
                  entries_.size(), rows, columns);
}

IntegerMatrix IntegerMatrix::identity(int size) {
  IntegerMatrix result(size, size);
  for (int i = 0; i < size; ++i) result.set(i, i, 1);
  return result;
}

IntegerMatrix operator*(const IntegerMatrix& a, const IntegerMatrix& b) {
  ISOCHOR_REQUIRE(a.columns() == b.rows(), a.columns(), b.rows());
  Scratch product(a.rows(), b.columns());
  if (a.columns() > 0 && a.rows() > 0 && b.columns() > 0) {
    fmpz_mat_mul(product.words(), View(a, a.entries_), View(b, b.entries_));
  }
  return product.take();
}

IntegerMatrix IntegerMatrix::transpose() const {
  IntegerMatrix result(columns_, rows_);
  for (int i = 0; i < rows_; ++i) {
    for (int j = 0; j < columns_; ++j) result.set(j, i, at(i, j));
  }
  return result;
}

int IntegerMatrix::rank() const {
  if (entries_.empty()) return 0;
  return static_cast<int>(fmpz_mat_rank(View(*this, entries_)));
}

Integer IntegerMatrix::determinant() const {
  ISOCHOR_REQUIRE(rows_ == columns_, rows_, columns_);
  Integer result(1);
  if (rows_ > 0) fmpz_mat_det(reinterpret_cast<fmpz*>(&result), View(*this, entries_));
  return result;
}

unsigned long IntegerMatrix::max_bits() const {
  unsigned long result = 0;
  for (const Integer& entry : entries_) result = std::max(result, entry.bits());
  return result;
}

bool IntegerMatrix::is_zero() const {
  return std::all_of(entries_.begin(), entries_.end(),
                     [](const Integer& entry) { return entry.is_zero(); });
}

HermiteForm IntegerMatrix::hermite_form() const {
  if (entries_.empty()) return {*this, identity(rows_)};
  Scratch form(rows_, columns_);
  Scratch transform(rows_, rows_);
  fmpz_mat_hnf_transform(form.words(), transform.words(), View(*this, entries_));
  return {form.take(), transform.take()};
}

IntegerMatrix IntegerMatrix::lll_reduced() const {
  // FLINT's reduction aborts on some dependent rows: pass it a basis.
  const int dimension = rank();
  if (dimension == 0) return IntegerMatrix(0, columns_);
  Scratch basis(dimension, columns_);
  if (dimension == rows_) {
    fmpz_mat_set(basis.words(), View(*this, entries_));
  } else {
    Scratch form(rows_, columns_);
    fmpz_mat_hnf(form.words(), View(*this, entries_));
    const IntegerMatrix rows = form.take_rows(0, dimension);
    fmpz_mat_set(basis.words(), View(rows, rows.entries_));
  }
  fmpz_lll_t parameters;
  fmpz_lll_context_init_default(parameters);
  fmpz_lll(basis.words(), nullptr, parameters);
  return basis.take();
}

IntegerMatrix IntegerMatrix::kernel_lattice() const {
  // U A^T = H: the rows of the unimodular U where H is zero are a basis of the kernel.
  const HermiteForm hermite = transpose().hermite_form();
  const int zeros = count_zero_rows(hermite.form);
  IntegerMatrix kernel(zeros, columns_);
  for (int i = 0; i < zeros; ++i) {
    for (int j = 0; j < columns_; ++j) {
      kernel.set(i, j, hermite.transform.at(columns_ - zeros + i, j));
    }
  }
  return kernel.lll_reduced();
}

bool operator==(const IntegerMatrix& a, const IntegerMatrix& b) {
  return a.rows_ == b.rows_ && a.columns_ == b.columns_ && a.entries_ == b.entries_;
}

}  // namespace isochor
