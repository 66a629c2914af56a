#include "isochor/ecles/relevant.h"

#include <algorithm>

#include "isochor/base/error.h"
#include "isochor/ecles/index_map.h"

namespace isochor {
namespace {

// Ascending, each number once: by marks where their range is not much longer than the list.
void sort_unique(std::vector<int>& numbers) {
  if (numbers.empty()) return;
  const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
  const int first = *low, range = *high - *low + 1;
  if (static_cast<size_t>(range) > 32 * numbers.size()) {
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return;
  }
  std::vector<char> marks(static_cast<size_t>(range));
  for (const int number : numbers) marks[static_cast<size_t>(number - first)] = 1;
  numbers.clear();
  for (int k = 0; k < range; ++k) {
    if (marks[static_cast<size_t>(k)] != 0) numbers.push_back(first + k);
  }
}

}  // namespace

Relevance relevant(const ConstraintMatrix& matrix, const Selection& selection) {
  std::vector<int> both = selection.anchors;
  both.insert(both.end(), selection.derived.begin(), selection.derived.end());
  for (const int parameter : both) {
    ISOCHOR_REQUIRE(0 <= parameter && parameter < matrix.parameters(), parameter,
                    matrix.parameters());
  }
  const internal::IndexMap chosen(both);
  ISOCHOR_REQUIRE(!chosen.has_repetition(), both.size());
  Relevance result;
  for (const int parameter : both) {
    const ArrayView<int> rows = matrix.column(parameter);
    result.rows.insert(result.rows.end(), rows.begin(), rows.end());
  }
  sort_unique(result.rows);
  for (const int row : result.rows) {
    for (const ConstraintTerm& term : matrix.row(row)) {
      if (!chosen.contains(term.parameter)) result.fixed.push_back(term.parameter);
    }
  }
  sort_unique(result.fixed);
  return result;
}

}  // namespace isochor
