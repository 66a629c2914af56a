// The checker of verdicts: small, slow where it may be, and without a line of the code it checks.
//
// Every verdict of analysis.h comes with something that proves it, and these functions read only
// that and the matrix: a determinant that is nonzero modulo any number is nonzero; multipliers are
// multiplied out. A false certificate is refused whatever made it. Symbols: analysis.h.
#pragma once

#include <vector>

#include "isochor/ecles/analysis.h"
#include "isochor/ecles/conflicts.h"

namespace isochor {

// The rows are independent on the columns. Numbers of rows and columns agree, no repetition.
bool verify(const MinorProof& proof, const ConstraintMatrix& matrix);

// y^T R = 0 on every derived parameter, rows ascending, no multiplier zero.
bool verify_dependent(const Circuit& circuit, const ConstraintMatrix& matrix,
                      const std::vector<int>& derived);

// All its rows but the first are independent on the derived parameters; with verify_dependent and
// nonzero multipliers, so are all but any one.
bool verify_minimal(const Circuit& circuit, const ConstraintMatrix& matrix,
                    const std::vector<int>& derived);

// The circuit is dependent and the conflict's residual is what the values make it, not zero.
bool verify_conflict(const Circuit& circuit, const Conflict& conflict,
                     const ConstraintMatrix& matrix, const Selection& selection,
                     const std::vector<std::vector<Rational>>& right_sides,
                     const std::vector<std::vector<Rational>>& values);

// The whole: E and F' are right; every row of E is either among the rows of a verified minor on
// derived parameters, or has a verified circuit of itself and independent rows; the obstructions
// are those circuits with y^T R_EA != 0.
bool verify(const Analysis& analysis, const ConstraintMatrix& matrix, const Selection& selection);

}  // namespace isochor
