// From any basis of rows to the first one.
//
// The independent sets of rows are a matroid: a basis is the first (in a given order) exactly when
// no circuit of a dependent row has a member after that row. Where one has, that member and the
// dependent row change places, and the member is eliminated from the other circuits with the
// circuit's relation. One pass is enough: what enters a circuit comes before the member that left.
#pragma once

#include <vector>

#include "isochor/ecles/relation.h"

namespace isochor::internal {

struct DependentRow {
  int row = 0;
  Relation relation;  // of itself and rows of the basis
};

// `order` holds each row once; `basis` has its members replaced in place.
void exchange_to_first(const std::vector<int>& order, std::vector<DependentRow>& dependents,
                       std::vector<int>& basis);

}  // namespace isochor::internal
