#include "isochor/ecles/local_system.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "isochor/ecles/index_map.h"

namespace isochor::internal {
namespace {

// A row is heavy when it is longer than both: kHeavyLength, kHeavyFactor times the median.
constexpr size_t kHeavyLength = 16;
constexpr size_t kHeavyFactor = 4;

size_t index(int i) { return static_cast<size_t>(i); }

size_t heavy_length(const LocalSystem& system) {
  std::vector<size_t> lengths;
  for (int i = 0; i < system.rows(); ++i) {
    if (!system.row(i).empty()) lengths.push_back(system.row(i).size());
  }
  if (lengths.empty()) return kHeavyLength;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return std::max(kHeavyLength, kHeavyFactor * *middle);
}

// How many active rows involve each column, and the exclusive or of their numbers: of one row, its
// number.
class ActiveRows {
 public:
  explicit ActiveRows(int columns) : cells_(index(columns)) {}

  void add(const LocalSystem& system, int row) {
    for (const LocalTerm& term : system.row(row)) {
      ++cells_[index(term.column)].count;
      cells_[index(term.column)].rows ^= row;
    }
  }
  bool single(int column) const { return cells_[index(column)].count == 1; }
  bool none(int column) const { return cells_[index(column)].count == 0; }
  int the_row(int column) const { return cells_[index(column)].rows; }
  void remove(int row, int column) {
    --cells_[index(column)].count;
    cells_[index(column)].rows ^= row;
  }

 private:
  struct Cell {
    int count = 0;
    int rows = 0;
  };
  std::vector<Cell> cells_;
};

void peel(const LocalSystem& system, ActiveRows& active, std::vector<bool>& done,
          std::vector<Structure::Peeled>& peeled) {
  std::vector<int> singles;
  for (int column = system.columns; column-- > 0;) {
    if (active.single(column)) singles.push_back(column);
  }
  while (!singles.empty()) {
    const int column = singles.back();
    singles.pop_back();
    if (!active.single(column)) continue;
    const int row = active.the_row(column);
    done[index(row)] = true;
    for (const LocalTerm& term : system.row(row)) {
      active.remove(row, term.column);
      if (active.single(term.column)) singles.push_back(term.column);
      if (term.column == column) peeled.push_back({row, column, term.value});
    }
  }
}

int root(std::vector<int>& parent, int i) {
  while (parent[index(i)] != i) {
    parent[index(i)] = parent[index(parent[index(i)])];
    i = parent[index(i)];
  }
  return i;
}

// The connected components of the rows; each column belongs to its rows' block.
std::vector<Block> connected_blocks(const LocalSystem& system, const std::vector<int>& rows) {
  std::vector<int> parent(index(system.rows()));
  std::iota(parent.begin(), parent.end(), 0);
  std::vector<int> first_row(index(system.columns), -1);
  for (const int row : rows) {
    for (const LocalTerm& term : system.row(row)) {
      int& first = first_row[index(term.column)];
      if (first < 0) first = row;
      parent[index(root(parent, row))] = root(parent, first);
    }
  }
  std::vector<Block> blocks;
  std::vector<int> block_of(index(system.rows()), -1);
  for (const int row : rows) {
    int& block = block_of[index(root(parent, row))];
    if (block < 0) {
      block = static_cast<int>(blocks.size());
      blocks.emplace_back();
    }
    blocks[index(block)].rows.push_back(row);
    for (const LocalTerm& term : system.row(row)) {
      if (first_row[index(term.column)] == row) {
        blocks[index(block)].columns.push_back(term.column);
      }
    }
  }
  std::vector<int> count(index(system.columns));
  for (const int row : rows) {
    for (const LocalTerm& term : system.row(row)) ++count[index(term.column)];
  }
  for (Block& block : blocks) {
    std::stable_sort(block.columns.begin(), block.columns.end(),
                     [&](int a, int b) { return count[index(a)] < count[index(b)]; });
  }
  return blocks;
}

}  // namespace

LocalSystem::LocalSystem(const ConstraintMatrix& matrix, const std::vector<int>& relevant_rows,
                         const std::vector<int>& derived)
    : columns(static_cast<int>(derived.size())) {
  const IndexMap local(derived);
  row_begin.reserve(relevant_rows.size() + 1);
  for (const int row : relevant_rows) {
    for (const ConstraintTerm& term : matrix.row(row)) {
      const int column = local[term.parameter];
      if (column == IndexMap::kNone) continue;
      const std::optional<long> word = term.coefficient.to_long();
      terms.push_back({column, word.has_value(), word.value_or(0), &term.coefficient});
    }
    row_begin.push_back(terms.size());
  }
}

Structure structure(const LocalSystem& system, const std::vector<int>& order) {
  const size_t longest = heavy_length(system);
  Structure result;
  ActiveRows active(system.columns);
  std::vector<bool> done(index(system.rows()));
  for (const int row : order) {
    const size_t length = system.row(row).size();
    if (length == 0) {
      result.empty.push_back(row);
    } else if (length > longest) {
      result.heavy.push_back(row);
    } else {
      active.add(system, row);
      continue;
    }
    done[index(row)] = true;
  }
  peel(system, active, done, result.peeled);
  std::vector<int> core;
  for (const int row : order) {
    if (!done[index(row)]) core.push_back(row);
  }
  result.blocks = connected_blocks(system, core);
  return result;
}

}  // namespace isochor::internal
