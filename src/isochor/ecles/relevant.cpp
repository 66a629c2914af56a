#include "isochor/ecles/relevant.h"

#include <algorithm>

#include "isochor/base/error.h"
#include "isochor/ecles/index_map.h"

namespace isochor {
namespace {

void sort_unique(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

}  // namespace

Relevance relevant(const ConstraintMatrix& matrix, const Selection& selection) {
  internal::IndexMap chosen(selection.anchors.size() + selection.derived.size());
  Relevance result;
  for (const std::vector<int>* parameters : {&selection.anchors, &selection.derived}) {
    for (const int parameter : *parameters) {
      ISOCHOR_REQUIRE(0 <= parameter && parameter < matrix.parameters(), parameter,
                      matrix.parameters());
      ISOCHOR_REQUIRE(chosen.insert(parameter, 0), parameter);  // chosen once
      const ArrayView<int> rows = matrix.column(parameter);
      result.rows.insert(result.rows.end(), rows.begin(), rows.end());
    }
  }
  sort_unique(result.rows);
  for (const int row : result.rows) {
    for (const ConstraintTerm& term : matrix.row(row)) {
      if (chosen[term.parameter] == internal::IndexMap::kNone) {
        result.fixed.push_back(term.parameter);
      }
    }
  }
  sort_unique(result.fixed);
  return result;
}

}  // namespace isochor
