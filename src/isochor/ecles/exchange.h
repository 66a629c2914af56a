// From any basis of rows to the first one.
//
// The independent sets of rows are a matroid: a basis is the first (in a given order) exactly when
// no circuit of a dependent row has a member after that row. Where one has, that member and the
// dependent row change places, and the member is eliminated from the other circuits with the
// circuit's relation. One pass is enough: what enters a circuit comes before the member that left.
#pragma once

#include <utility>
#include <vector>

#include "isochor/ecles/relation.h"

namespace isochor::internal {

struct DependentRow {
  int row = 0;
  Relation relation;  // of itself and rows of the basis
};

// `order` holds each row once; `basis` has its members replaced in place. A member with multiplier
// y for a row with multiplier y' makes the basis' minor y / y' times what it was: false when y is a
// multiple of the prime, which then cannot prove the new basis.
bool exchange_to_first(const std::vector<int>& order, unsigned long prime,
                       std::vector<DependentRow>& dependents, std::vector<int>& basis);

// sum coefficient row(r) = 0 modulo a prime; ascending by row, none zero.
using ModularRelation = std::vector<std::pair<int, Residue>>;

// The rows outside the first basis, modulo the prime, ascending: relations[k] is that of one row
// and a basis, rows_in_order are all of these rows.
std::vector<int> dependent_on_first(const PrimeField& field, const std::vector<int>& rows_in_order,
                                    std::vector<ModularRelation> relations);

}  // namespace isochor::internal
