// Gauss elimination over the rationals, by the book and nothing else: what the exact engine is held
// against. It shares no code with the engine but the numbers themselves.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "isochor/exact/rational.h"

namespace isochor::test {

using Table = std::vector<std::vector<Rational>>;  // rows of equal length

struct Echelon {
  Table rows;                        // leading ones, zeros above and below; rows of zeros last
  std::vector<size_t> pivots;        // the column of each leading one
  std::vector<size_t> row_of_pivot;  // the given row that each leading one came from
};

// Reduces; pivots are looked for in the first `columns` columns only.
inline Echelon eliminated(Table table, size_t columns) {
  Echelon result;
  std::vector<size_t> given(table.size());
  for (size_t i = 0; i < given.size(); ++i) given[i] = i;
  for (size_t column = 0; column < columns && result.pivots.size() < table.size(); ++column) {
    const size_t row = result.pivots.size();
    size_t found = row;
    while (found < table.size() && table[found][column].is_zero()) ++found;
    if (found == table.size()) continue;
    std::swap(table[row], table[found]);
    std::swap(given[row], given[found]);
    const Rational pivot = table[row][column];
    for (Rational& entry : table[row]) entry /= pivot;
    for (size_t i = 0; i < table.size(); ++i) {
      if (i == row || table[i][column].is_zero()) continue;
      const Rational factor = table[i][column];
      for (size_t j = column; j < table[i].size(); ++j) table[i][j] -= factor * table[row][j];
    }
    result.pivots.push_back(column);
    result.row_of_pivot.push_back(given[row]);
  }
  result.rows = std::move(table);
  return result;
}

inline size_t rank(const Table& table) {
  return table.empty() ? 0 : eliminated(table, table.front().size()).pivots.size();
}

// [a b], side by side; both have as many rows.
inline Table beside(Table a, const Table& b) {
  for (size_t i = 0; i < a.size(); ++i) a[i].insert(a[i].end(), b[i].begin(), b[i].end());
  return a;
}

// Whether each column of b is a combination of the columns of a.
inline bool in_column_space(const Table& a, const Table& b) {
  return rank(beside(a, b)) == rank(a);
}

inline Table transposed(const Table& table, size_t columns) {
  Table result(columns, std::vector<Rational>(table.size()));
  for (size_t i = 0; i < table.size(); ++i) {
    for (size_t j = 0; j < columns; ++j) result[j][i] = table[i][j];
  }
  return result;
}

inline Table multiplied(const Table& a, const Table& b, size_t columns_of_b) {
  Table result(a.size(), std::vector<Rational>(columns_of_b));
  for (size_t i = 0; i < a.size(); ++i) {
    for (size_t k = 0; k < b.size(); ++k) {
      if (a[i][k].is_zero()) continue;
      for (size_t j = 0; j < columns_of_b; ++j) result[i][j] += a[i][k] * b[k][j];
    }
  }
  return result;
}

}  // namespace isochor::test
