// The part of a constraint system that a choice of parameters touches.
//
// Symbols (Rodrigues 2017, 5.1): A anchors, the parameters with given values; D derived, those that
// may follow; every other parameter is fixed. E, the relevant constraints, are the rows with a
// nonzero coefficient on A u D. (The thesis' Algorithm 2 leaves the word nonzero out.) F' are the
// fixed parameters of those rows.
//
// Law: the cost follows the answer, O(k log k) for k nonzeros in E, whatever the size of R.
#pragma once

#include <vector>

#include "isochor/ecles/constraint_matrix.h"

namespace isochor {

// Disjoint, without repetition, in any order.
struct Selection {
  std::vector<int> anchors;
  std::vector<int> derived;
};

struct Relevance {
  std::vector<int> rows;   // E, ascending
  std::vector<int> fixed;  // F', ascending
};

// PreconditionError when a parameter is out of range or chosen twice.
Relevance relevant(const ConstraintMatrix& matrix, const Selection& selection);

}  // namespace isochor
