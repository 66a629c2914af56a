// Constraints of an edit that contradict each other, as users wrote them, with the proof.
#pragma once

#include <string>
#include <vector>

#include "isochor/exact/rational.h"

namespace isochor {

// The sum of multipliers[k] times an equation of constraints[k] reads 0 = residual. The set is
// minimal: without any one of its equations the others can be met.
struct NamedConflict {
  std::vector<std::string> constraints;  // one per equation
  std::vector<Rational> multipliers;     // of those equations; the first is 1
  double residual = 0.0;                 // a length
};

}  // namespace isochor
