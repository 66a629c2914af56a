// Random edits: constraints of every kind, a choice of anchors and derived parameters, values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <random>
#include <vector>

#include "ecles/matrix_tables.h"
#include "ecles/rational_elimination.h"
#include "isochor/ecles/constraint_matrix.h"
#include "isochor/ecles/relevant.h"
#include "isochor/exact/rational_matrix.h"

namespace isochor::test {

inline std::vector<RationalTerms> terms_of(const Table& rows) {
  std::vector<RationalTerms> result(rows.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    for (size_t j = 0; j < rows[i].size(); ++j) {
      if (!rows[i][j].is_zero()) result[i].emplace_back(static_cast<int>(j), rows[i][j]);
    }
  }
  return result;
}

// Right sides that the values satisfy, three times in four.
struct System {
  Table rows;
  int parameters = 0;
  int components = 0;
  Selection selection;
  RationalMatrix right, values;
};

// What entries are multiplied by: 1, 2^200, 2^-200 row by row, or either entry by entry.
enum class Size { kPlain, kHuge, kTiny, kBoth };

inline Rational entry_scale(std::mt19937_64& random, Size size) {
  const bool up = size == Size::kHuge || (size == Size::kBoth && random() % 2 == 0);
  if (size == Size::kPlain) return 1;
  return Rational(1).scaled_by_power_of_two(up ? 200 : -200);
}

inline RationalMatrix random_values(std::mt19937_64& random, int rows, int columns) {
  RationalMatrix result(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int c = 0; c < columns; ++c) {
      result.set(i, c, Rational(static_cast<long>(random() % 201) - 100, 1 + random() % 8));
    }
  }
  return result;
}

inline System random_system(std::mt19937_64& random, const RandomMatrix& wanted, Size size,
                            int components) {
  System system;
  system.rows = table_of(random_matrix(random, wanted));
  for (auto& row : system.rows) {
    const Rational of_row = entry_scale(random, size);
    for (Rational& entry : row) entry *= size == Size::kBoth ? entry_scale(random, size) : of_row;
  }
  system.parameters = wanted.columns;
  system.components = components;
  std::vector<int> order(static_cast<size_t>(wanted.columns));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  const size_t anchors = order.empty() ? 0 : random() % (order.size() / 2 + 1);
  const size_t derived = random() % (order.size() - anchors + 1);
  system.selection.anchors.assign(order.begin(), order.begin() + static_cast<long>(anchors));
  system.selection.derived.assign(order.begin() + static_cast<long>(anchors),
                                  order.begin() + static_cast<long>(anchors + derived));
  system.values = random_values(random, wanted.columns, components);
  if (random() % 4 == 0) {
    system.right = random_values(random, wanted.rows, components);
  } else {
    const Table product =
        multiplied(system.rows, table_of(system.values), static_cast<size_t>(components));
    system.right = RationalMatrix(wanted.rows, components);
    for (int i = 0; i < wanted.rows; ++i) {
      for (int c = 0; c < components; ++c) {
        system.right.set(i, c, product[static_cast<size_t>(i)][static_cast<size_t>(c)]);
      }
    }
  }
  return system;
}

}  // namespace isochor::test
