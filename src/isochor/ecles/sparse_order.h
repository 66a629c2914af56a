// An order of a block's rows in which elimination fills in little.
//
// Elimination is acted out on the pattern alone (Markowitz 1957, one column at a time): of the
// columns that the fewest rows involve, one; of those rows the shortest. It ends where a quarter of
// what remains is filled: there is nothing to gain any more.
#pragma once

#include <vector>

#include "isochor/ecles/local_system.h"

namespace isochor::internal {

struct PlannedPivot {
  int row = 0;
  int column = -1;  // where the row should have its pivot; -1: anywhere
};

// All rows of the block; those at the end, without a column, in the block's own order. Cost: that
// of the elimination it plans, without arithmetic.
std::vector<PlannedPivot> sparse_order(const LocalSystem& system, const Block& block);

}  // namespace isochor::internal
