// A problem as the numbered system that the algorithms work on. Internal to `solve`.
#pragma once

#include <string>
#include <vector>

#include "isochor/ecles/analysis.h"
#include "isochor/ecles/problem.h"

namespace isochor::internal {

// The parameters and the constraints of a problem, prepared for the analysis.
struct ProblemSystem {
  ConstraintMatrix matrix;
  Selection selection;
  std::vector<int> precedence;                     // by name
  std::vector<std::vector<Rational>> right_sides;  // component by component, as given
  std::vector<std::vector<Rational>> values;       // likewise; anchors new, the others as they are
};

ProblemSystem system_of(const Problem& problem);

struct DerivedValues {
  // By component, then by derived parameter in the order of the problem.
  std::vector<std::vector<Rational>> values;
  // Why there are none: a limit was reached.
  std::string refused;
};

// The nearest values, by the method the problem asks for. The problem must be weakly solvable.
// Limits: exact values of 65 536 binary digits each and 128 MB together; for the methods of the
// thesis, which are dense, 100 000 coefficients, and 16 rows for `plain`, whose numbers double in
// length with each.
DerivedValues derived_values(const Problem& problem, const ProblemSystem& system,
                             const Analysis& analysis);

}  // namespace isochor::internal
