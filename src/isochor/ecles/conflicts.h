// Which constraints contradict each other for given values.
//
// Symbols: analysis.h; given row i reads  g_i . p = q_i, stored row i is R_i = s_i g_i with
// s_i = scale(i). With y the multipliers of a circuit, y^T R_ED = 0, so that the sum of y_i s_i
// times the constraints says  0 = y^T (s q - R_EA p_A - R_EF p_F),  the residual, which no choice
// of the derived parameters can change.
//
// Laws: (1) the constraints E can be met by derived parameters exactly when there are no conflicts;
//       (2) the rows of a conflict's circuit are a minimal set of constraints that cannot be met
//           together: without any one of them the others can.
#pragma once

#include <vector>

#include "isochor/ecles/analysis.h"
#include "isochor/exact/rational.h"

namespace isochor {

struct Conflict {
  int circuit = 0;    // of the analysis
  int component = 0;  // of multidimensional parameters
  Rational residual;  // not zero
};

// right_sides[c][i] is q_i of component c as given, values[c][j] the value of parameter j with
// anchors at their new places; values of derived parameters are not used. Ascending by component,
// then by circuit.
std::vector<Conflict> conflicts(const ConstraintMatrix& matrix, const Analysis& analysis,
                                const std::vector<std::vector<Rational>>& right_sides,
                                const std::vector<std::vector<Rational>>& values);

// The residual of one circuit in one component.
Rational residual(const ConstraintMatrix& matrix, const Circuit& circuit,
                  const std::vector<Rational>& right_side, const std::vector<Rational>& values);

// The multipliers of the constraints as they were given: y_i s_i.
std::vector<Rational> given_multipliers(const ConstraintMatrix& matrix, const Circuit& circuit);

}  // namespace isochor
