#include "isochor/ecles/ldu.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "isochor/base/error.h"

namespace isochor {
namespace {

// The state of Algorithm 6. For a row t that is still to be eliminated, L_tt and D_tt are kept in
// vectors of their own: the columns of L and the entries of D they would occupy need not exist.
class Elimination {
 public:
  Elimination(IntegerMatrix a, Simplification simplification)
      : rows_(a.rows()),
        columns_(a.columns()),
        simplification_(simplification),
        upper_(std::move(a)),
        lower_(rows_, std::min(rows_, columns_)),
        pending_lower_(static_cast<size_t>(rows_), Integer(1)),
        diagonal_(static_cast<size_t>(rows_), Integer(1)),
        row_order_(static_cast<size_t>(rows_)),
        column_order_(static_cast<size_t>(columns_)) {
    std::iota(row_order_.begin(), row_order_.end(), 0);
    std::iota(column_order_.begin(), column_order_.end(), 0);
  }

  LduFactoring run(const LduObserver& observer) {
    int last = columns_ - 1;  // columns behind it are zero in the rows from i
    int i = 0;
    for (; i < rows_ && i <= last; ++i) {
      last = gather_nonzero_columns(i, last);
      if (last < i) break;
      bring_pivot(i, last);
      if (i == 0 && simplification_ == Simplification::kGcd) simplify_row_by_gcd(0, 0);
      lower_.set(i, i, pending(i) * upper_.at(i, i));
      diagonal(i) *= upper_.at(i, i);
      for (int t = i + 1; t < rows_; ++t) {
        eliminate(i, t);
        if (simplification_ == Simplification::kGcd) simplify_row_by_gcd(i + 1, t);
        if (simplification_ == Simplification::kTurner && i > 0) divide_by_earlier_pivot(i, t);
      }
      if (simplification_ == Simplification::kGcd) simplify_column_by_gcd(i);
      if (observer) observer(measure(i));
    }
    return without_null_parts(i);
  }

 private:
  Integer& pending(int t) { return pending_lower_[static_cast<size_t>(t)]; }
  Integer& diagonal(int t) { return diagonal_[static_cast<size_t>(t)]; }

  bool column_is_zero(int i, int column) const {
    for (int t = i; t < rows_; ++t) {
      if (!upper_.at(t, column).is_zero()) return false;
    }
    return true;
  }

  // Moves columns that are zero in the rows from i behind the others; the last of the others.
  int gather_nonzero_columns(int i, int last) {
    for (int column = i; column <= last;) {
      if (column_is_zero(i, column)) {
        swap_columns(column, last--);
      } else {
        ++column;
      }
    }
    return last;
  }

  void bring_pivot(int i, int last) {
    int row = -1;
    int column = -1;
    for (int p = i; p < rows_; ++p) {
      for (int q = i; q <= last; ++q) {
        const Integer& entry = upper_.at(p, q);
        if (entry.is_zero()) continue;
        if (row < 0 || compare_magnitudes(entry, upper_.at(row, column)) < 0) {
          row = p;
          column = q;
        }
      }
    }
    swap_columns(i, column);
    swap_rows(i, row);
  }

  void swap_columns(int a, int b) {
    if (a == b) return;
    for (int t = 0; t < rows_; ++t) std::swap(upper_.at(t, a), upper_.at(t, b));
    std::swap(column_order_[static_cast<size_t>(a)], column_order_[static_cast<size_t>(b)]);
  }

  // Of L only the finished columns move, and L_tt with its row.
  void swap_rows(int i, int other) {
    if (i == other) return;
    for (int s = 0; s < columns_; ++s) std::swap(upper_.at(i, s), upper_.at(other, s));
    for (int s = 0; s < i; ++s) std::swap(lower_.at(i, s), lower_.at(other, s));
    std::swap(pending(i), pending(other));
    std::swap(diagonal(i), diagonal(other));
    std::swap(row_order_[static_cast<size_t>(i)], row_order_[static_cast<size_t>(other)]);
  }

  void eliminate(int i, int t) {
    const Integer& pivot = upper_.at(i, i);
    const Integer factor = std::move(upper_.at(t, i));
    upper_.set(t, i, Integer());
    lower_.set(t, i, pending(t) * factor);
    diagonal(t) *= pivot;
    for (int s = i + 1; s < columns_; ++s) {
      Integer& entry = upper_.at(t, s);
      entry *= pivot;
      entry.subtract_product(factor, upper_.at(i, s));
    }
  }

  void simplify_row_by_gcd(int begin, int t) {
    Integer common;
    for (int s = begin; s < columns_ && common != 1; ++s) common = gcd(common, upper_.at(t, s));
    if (common.is_zero() || common == 1) return;
    for (int s = begin; s < columns_; ++s) upper_.at(t, s).divide_exactly(common);
    pending(t) *= common;
  }

  void divide_by_earlier_pivot(int i, int t) {
    const Integer& earlier = upper_.at(i - 1, i - 1);
    for (int s = i + 1; s < columns_; ++s) upper_.at(t, s).divide_exactly(earlier);
    diagonal(t).divide_exactly(earlier);
  }

  void simplify_column_by_gcd(int i) {
    Integer common = diagonal(i);
    for (int t = i; t < rows_ && common != 1; ++t) common = gcd(common, lower_.at(t, i));
    if (common.abs() == 1) return;
    diagonal(i).divide_exactly(common);
    for (int t = i; t < rows_; ++t) lower_.at(t, i).divide_exactly(common);
  }

  LduStep measure(int i) const {
    LduStep result{i + 1, upper_.max_bits(), lower_.max_bits(), 0};
    for (int t = 0; t < rows_; ++t) {
      const auto row = static_cast<size_t>(t);
      result.diagonal_bits = std::max(result.diagonal_bits, diagonal_[row].bits());
      if (t > i) result.lower_bits = std::max(result.lower_bits, pending_lower_[row].bits());
    }
    return result;
  }

  LduFactoring without_null_parts(int rank) {
    LduFactoring result{std::move(row_order_), std::move(column_order_), IntegerMatrix(rows_, rank),
                        std::move(diagonal_), IntegerMatrix(rank, columns_)};
    result.diagonal.resize(static_cast<size_t>(rank));
    for (int k = 0; k < rank; ++k) {
      for (int t = k; t < rows_; ++t) result.lower.set(t, k, std::move(lower_.at(t, k)));
      for (int s = k; s < columns_; ++s) result.upper.set(k, s, std::move(upper_.at(k, s)));
    }
    return result;
  }

  int rows_, columns_;
  Simplification simplification_;
  IntegerMatrix upper_, lower_;
  std::vector<Integer> pending_lower_, diagonal_;
  std::vector<int> row_order_, column_order_;
};

// X = L^^-1 B^, by forward substitution down the columns of B.
RationalMatrix forward_substituted(const LduFactoring& factoring, const RationalMatrix& b) {
  ISOCHOR_REQUIRE(b.rows() == factoring.rows(), b.rows(), factoring.rows());
  RationalMatrix x(factoring.rank(), b.columns());
  for (int k = 0; k < x.rows(); ++k) {
    for (int c = 0; c < x.columns(); ++c) {
      Rational sum = b.at(factoring.row_order[static_cast<size_t>(k)], c);
      for (int s = 0; s < k; ++s) {
        if (!factoring.lower.at(k, s).is_zero()) sum -= factoring.lower.at(k, s) * x.at(s, c);
      }
      x.set(k, c, sum / factoring.lower.at(k, k));
    }
  }
  return x;
}

}  // namespace

LduFactoring factor_ldu(IntegerMatrix a, Simplification simplification,
                        const LduObserver& observer) {
  return Elimination(std::move(a), simplification).run(observer);
}

RationalMatrix product(const LduFactoring& factoring) {
  RationalMatrix scaled = factoring.upper;
  for (int k = 0; k < scaled.rows(); ++k) {
    for (int s = 0; s < scaled.columns(); ++s) {
      scaled.at(k, s) /= factoring.diagonal[static_cast<size_t>(k)];
    }
  }
  const RationalMatrix permuted = RationalMatrix(factoring.lower) * scaled;
  RationalMatrix result(factoring.rows(), factoring.columns());
  for (int i = 0; i < result.rows(); ++i) {
    for (int j = 0; j < result.columns(); ++j) {
      result.set(factoring.row_order[static_cast<size_t>(i)],
                 factoring.column_order[static_cast<size_t>(j)], permuted.at(i, j));
    }
  }
  return result;
}

bool reaches(const LduFactoring& factoring, const RationalMatrix& b) {
  const RationalMatrix x = forward_substituted(factoring, b);
  for (int t = factoring.rank(); t < factoring.rows(); ++t) {
    for (int c = 0; c < b.columns(); ++c) {
      Rational sum;
      for (int s = 0; s < factoring.rank(); ++s) sum += factoring.lower.at(t, s) * x.at(s, c);
      if (sum != b.at(factoring.row_order[static_cast<size_t>(t)], c)) return false;
    }
  }
  return true;
}

RationalMatrix particular_solution(const LduFactoring& factoring, const RationalMatrix& b) {
  RationalMatrix x = forward_substituted(factoring, b);
  RationalMatrix result(factoring.columns(), b.columns());
  for (int c = 0; c < b.columns(); ++c) {
    for (int k = factoring.rank() - 1; k >= 0; --k) {
      Rational sum = x.at(k, c) * factoring.diagonal[static_cast<size_t>(k)];  // Y, eq. (8.5)
      for (int s = k + 1; s < factoring.rank(); ++s) {
        if (!factoring.upper.at(k, s).is_zero()) sum -= factoring.upper.at(k, s) * x.at(s, c);
      }
      x.set(k, c, sum / factoring.upper.at(k, k));
      result.set(factoring.column_order[static_cast<size_t>(k)], c, x.at(k, c));
    }
  }
  return result;
}

}  // namespace isochor
