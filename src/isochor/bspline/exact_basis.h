// B-spline basis functions at one parameter, as rational numbers.
//
// Knots and parameters are doubles, so the values are rationals without any rounding: what exact
// verdicts about points of a surface rest on.
#pragma once

#include <vector>

#include "isochor/bspline/knots.h"
#include "isochor/exact/rational.h"

namespace isochor {

// The d + 1 functions that may be nonzero at a parameter: values[j] is B_{first+j}, and slopes[j]
// its first derivative.
struct ExactBasisValues {
  int first = 0;
  std::vector<Rational> values;
  std::vector<Rational> slopes;
};

// The Cox-de Boor recursion at u on the span span_of(u). PreconditionError when u is not finite.
// Cost O(d^2) rational operations.
ExactBasisValues evaluate_exact_basis(const KnotVector& knots, double u);

}  // namespace isochor
