// The relation between a few rows, by elimination over the integers.
//
// Symbols: s rows R_i, of which any s - 1 are expected to be independent; the y with y^T R = 0 are
// then the multiples of one. Each column is an equation for y; equations are brought to echelon
// form, each freed of its common factor, so that numbers stay about as long as the answer.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "isochor/ecles/local_system.h"

namespace isochor::internal {

// sum multiplier row(r) = 0 on every column, integers without common factor, none zero.
using Relation = std::vector<std::pair<int, Integer>>;

// Nothing when the rows are independent, or when the relation does not involve all of them: then
// they are not a minimal dependent set. Cost: s^2 operations for each of at most s - 1 equations
// that say something new, and one pass over the others.
std::optional<Relation> small_relation(const LocalSystem& system, const std::vector<int>& rows);

}  // namespace isochor::internal
