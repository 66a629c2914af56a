// Gaussian elimination of sparse rows modulo a prime, kept as a list of pivots.
//
// Symbols: pivot k belongs to row r_k and column c_k. Its reduced row U_k has 1 at c_k and nothing
// at the columns of earlier pivots; U_k = i_k (row r_k - sum over j < k of f_kj U_j) modulo p.
// Any vector v over the columns reduces to v = sum c_k U_k + rest, the rest without entries at the
// columns of pivots; v lies in the span of the rows exactly when the rest is zero. Working on a
// block, only its pivots, from `first` on, can matter.
#pragma once

#include <vector>

#include "isochor/ecles/local_system.h"
#include "isochor/ecles/prime_field.h"

namespace isochor::internal {

class Elimination {
 public:
  Elimination(const LocalSystem& system, const PrimeField& field)
      : system_(system), field_(field), vector_(static_cast<size_t>(system.columns)) {}

  const LocalSystem& system() const { return system_; }
  const PrimeField& field() const { return field_; }
  int pivots() const { return static_cast<int>(pivots_.size()); }
  int row(int k) const { return pivots_[static_cast<size_t>(k)].row; }
  int column(int k) const { return pivots_[static_cast<size_t>(k)].column; }

  // Numbers stored for the pivots.
  size_t stored() const { return upper_.size() + factors_.size(); }
  // Forgets all pivots but the first so many.
  void keep(int pivots);

  // The vector at work, all zeros between uses.
  std::vector<Residue>& vector() { return vector_; }
  void load(int row);
  // vector -= sum c_k U_k, k >= first; the c_k are kept.
  void reduce(int first);
  // The first of the columns at which the vector is not zero, or -1.
  int nonzero_column(const std::vector<int>& columns) const;
  // What remains of the row that was loaded and reduced becomes a pivot; the vector, which has no
  // entries outside the columns, becomes zero.
  void add_pivot(int row, int column, int first, const std::vector<int>& columns);
  // After reduce to zero: the y with vector = sum y_k row(r_k), y[k - first] for k >= first.
  const std::vector<Residue>& combination(int first);

 private:
  struct Pivot {
    int row = 0, column = 0;
    Residue inverse = 0;                        // i_k
    size_t upper_begin = 0, upper_end = 0;      // U_k
    size_t factors_begin = 0, factors_end = 0;  // f_kj
  };
  struct Entry {
    int index = 0;  // a column, or a pivot
    Residue value = 0;
  };

  const LocalSystem& system_;
  PrimeField field_;
  std::vector<Pivot> pivots_;
  std::vector<Entry> upper_, factors_;
  std::vector<Residue> vector_, coefficients_, combination_;
};

}  // namespace isochor::internal
