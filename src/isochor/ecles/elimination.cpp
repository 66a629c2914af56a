#include "isochor/ecles/elimination.h"

namespace isochor::internal {
namespace {

size_t index(int i) { return static_cast<size_t>(i); }

}  // namespace

void Elimination::keep(int pivots) {
  if (pivots >= this->pivots()) return;
  upper_.resize(pivots_[index(pivots)].upper_begin);
  factors_.resize(pivots_[index(pivots)].factors_begin);
  pivots_.resize(index(pivots));
}

void Elimination::load(int row) {
  for (const LocalTerm& term : system_.row(row)) {
    vector_[index(term.column)] = term.is_word ? field_.of(term.word) : field_.of(*term.value);
  }
}

void Elimination::reduce(int first) {
  coefficients_.resize(pivots_.size());
  const PrimeField field = field_;  // in registers: writing residues cannot change it
  Residue* const vector = vector_.data();
  for (size_t k = index(first); k < pivots_.size(); ++k) {
    const Pivot& pivot = pivots_[k];
    const Residue coefficient = vector[pivot.column];
    coefficients_[k] = coefficient;
    if (coefficient == 0) continue;
    const PrimeField::Factor factor = field.factor(field.negative(coefficient));
    const Entry* const end = upper_.data() + pivot.upper_end;
    for (const Entry* entry = upper_.data() + pivot.upper_begin; entry != end; ++entry) {
      Residue& target = vector[entry->index];
      target = field.add(target, field.multiply(entry->value, factor));
    }
  }
}

int Elimination::nonzero_column(const std::vector<int>& columns) const {
  for (const int column : columns) {
    if (vector_[index(column)] != 0) return column;
  }
  return -1;
}

void Elimination::add_pivot(int row, int column, int first, const std::vector<int>& columns) {
  Pivot pivot;
  pivot.row = row;
  pivot.column = column;
  pivot.inverse = field_.inverse(vector_[index(column)]);
  const PrimeField::Factor inverse = field_.factor(pivot.inverse);
  pivot.upper_begin = upper_.size();
  for (const int j : columns) {
    Residue& value = vector_[index(j)];
    if (value != 0) upper_.push_back({j, field_.multiply(value, inverse)});
    value = 0;
  }
  pivot.upper_end = upper_.size();
  pivot.factors_begin = factors_.size();
  for (int j = first; j < pivots(); ++j) {
    if (coefficients_[index(j)] != 0) factors_.push_back({j, coefficients_[index(j)]});
  }
  pivot.factors_end = factors_.size();
  pivots_.push_back(pivot);
}

const std::vector<Residue>& Elimination::combination(int first) {
  // U_k goes over into its row and earlier U_j, the last first.
  combination_.assign(pivots_.size() - index(first), 0);
  for (size_t k = pivots_.size(); k-- > index(first);) {
    if (coefficients_[k] == 0) continue;
    const Residue y = field_.multiply(coefficients_[k], pivots_[k].inverse);
    combination_[k - index(first)] = y;
    const PrimeField::Factor factor = field_.factor(y);
    for (size_t t = pivots_[k].factors_begin; t < pivots_[k].factors_end; ++t) {
      Residue& target = coefficients_[index(factors_[t].index)];
      target = field_.subtract(target, field_.multiply(factors_[t].value, factor));
    }
  }
  return combination_;
}

}  // namespace isochor::internal
