// B-spline basis functions and their derivatives at one parameter.
#pragma once

#include <array>

#include "isochor/bspline/knots.h"

namespace isochor {

// The d + 1 functions that may be nonzero at a parameter: B_first .. B_{first+d}.
// value(r, j) is the r-th derivative of B_{first+j}.
class BasisValues {
 public:
  static constexpr int kMaxOrder = 3;

  int first = 0;
  int degree = 0;

  double value(int derivative, int j) const { return values_[derivative][j]; }
  double& value(int derivative, int j) { return values_[derivative][j]; }

 private:
  std::array<std::array<double, kMaxDegree + 1>, kMaxOrder + 1> values_;
};

// Values and derivatives up to `order` (0..3) at u, by the Cox-de Boor recursion; beyond the degree
// they are zero. Outside the domain the end spans are continued. Cost O(d^2).
// Error: a few d * eps relative in each value (all terms of the recursion are non-negative).
BasisValues evaluate_basis(const KnotVector& knots, double u, int order = 0);

// The same on a chosen span (a one-sided derivative at a knot).
// PreconditionError when the span is outside the domain or empty.
BasisValues evaluate_basis_on_span(const KnotVector& knots, int span, double u, int order = 0);

}  // namespace isochor
