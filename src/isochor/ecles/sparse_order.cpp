#include "isochor/ecles/sparse_order.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "isochor/ecles/index_map.h"

namespace isochor::internal {
namespace {

// Of the remaining rows times columns, the part that may be filled before planning ends: one in so
// many.
constexpr size_t kDense = 4;

size_t index(int i) { return static_cast<size_t>(i); }

// Rows and columns numbered within the block.
class Pattern {
 public:
  Pattern(const LocalSystem& system, const Block& block)
      : rows_(block.rows.size()), active_(block.rows.size(), true), holders_(block.columns.size()) {
    const IndexMap column_place(block.columns);
    for (size_t i = 0; i < rows_.size(); ++i) {
      for (const LocalTerm& term : system.row(block.rows[i])) {
        rows_[i].push_back(column_place[term.column]);
      }
      std::sort(rows_[i].begin(), rows_[i].end());
      for (const int column : rows_[i]) holders_[index(column)].push_back(static_cast<int>(i));
      entries_ += rows_[i].size();
    }
    rows_left_ = rows_.size();
    counts_.resize(holders_.size());
    for (size_t j = 0; j < holders_.size(); ++j) {
      counts_[j] = holders_[j].size();
      queue_.insert({counts_[j], static_cast<int>(j)});
    }
  }

  bool is_active(size_t row) const { return active_[row]; }
  bool worth_planning() const {
    return !queue_.empty() && kDense * entries_ < rows_left_ * queue_.size();
  }
  // The next row and column; the row is -1 when no row involves the column any more.
  std::pair<int, int> eliminate_next() {
    const int column = queue_.begin()->second;
    queue_.erase(queue_.begin());
    const std::vector<int> rows = rows_with(column);
    if (rows.empty()) return {-1, column};
    const int pivot = *std::min_element(rows.begin(), rows.end(), [&](int a, int b) {
      return rows_[index(a)].size() < rows_[index(b)].size();
    });
    active_[index(pivot)] = false;
    --rows_left_;
    entries_ -= rows_[index(pivot)].size();
    for (const int j : rows_[index(pivot)]) change_count(j, column, -1);
    for (const int row : rows) {
      if (row != pivot) merge(row, rows_[index(pivot)], column);
    }
    return {pivot, column};
  }

 private:
  std::vector<int> rows_with(int column) const {
    std::vector<int> rows;
    for (const int row : holders_[index(column)]) {
      if (active_[index(row)]) rows.push_back(row);
    }
    return rows;
  }
  void change_count(int column, int eliminated, int by) {
    if (column == eliminated) return;
    queue_.erase({counts_[index(column)], column});
    counts_[index(column)] += static_cast<size_t>(by);
    queue_.insert({counts_[index(column)], column});
  }
  // The row after subtracting the pivot's row.
  void merge(int row, const std::vector<int>& pivot_row, int column) {
    std::vector<int> both;
    std::vector<int>& old = rows_[index(row)];
    std::set_union(old.begin(), old.end(), pivot_row.begin(), pivot_row.end(),
                   std::back_inserter(both));
    both.erase(std::lower_bound(both.begin(), both.end(), column));
    for (const int j : pivot_row) {
      if (j == column || std::binary_search(old.begin(), old.end(), j)) continue;
      holders_[index(j)].push_back(row);
      change_count(j, column, 1);
    }
    entries_ += both.size();
    entries_ -= old.size();
    old = std::move(both);
  }

  std::vector<std::vector<int>> rows_;  // columns, ascending
  std::vector<bool> active_;
  std::vector<std::vector<int>> holders_;  // of each column, rows no longer active included
  std::vector<size_t> counts_;
  std::set<std::pair<size_t, int>> queue_;
  size_t entries_ = 0, rows_left_ = 0;
};

}  // namespace

std::vector<PlannedPivot> sparse_order(const LocalSystem& system, const Block& block) {
  Pattern pattern(system, block);
  std::vector<PlannedPivot> order;
  while (pattern.worth_planning()) {
    const auto [row, column] = pattern.eliminate_next();
    if (row >= 0) order.push_back({block.rows[index(row)], block.columns[index(column)]});
  }
  for (size_t i = 0; i < block.rows.size(); ++i) {
    if (pattern.is_active(i)) order.push_back({block.rows[i], -1});
  }
  return order;
}

}  // namespace isochor::internal
