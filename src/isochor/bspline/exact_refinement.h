// Knot insertion in rational arithmetic: the same matrices as refinement.h, without rounding.
//
// Knots are doubles, hence rationals, so the matrix M of b_j = sum_i M(i,j) B_i is rational.
// Equations between poles are carried from a fine grid to a coarse one with it: r . P = 0 with
// P = M p is (r M) . p = 0.
//
// Laws:
//  (1) the rows are those of insertion_map (wrapped_insertion_map) before rounding;
//  (2) every row adds up to exactly 1.
#pragma once

#include <vector>

#include "isochor/bspline/knots.h"
#include "isochor/exact/rational.h"

namespace isochor {

// Row i of a rational matrix: its nonzeros stand side by side from column `first` on.
struct ExactMapRow {
  int first = 0;
  std::vector<Rational> coefficients;  // neither the first nor the last is zero
};
using ExactMap = std::vector<ExactMapRow>;

// Preconditions as for insertion_map. Cost O(m d^2) rational operations.
ExactMap exact_insertion_map(const KnotVector& coarse, const KnotVector& fine);
// Preconditions as for wrapped_insertion_map. Knots beyond the ends are taken as those inside,
// shifted by exact periods.
ExactMap exact_wrapped_insertion_map(const KnotVector& coarse, const KnotVector& fine);

// The derivative of order r at t of the functions span - d .. span, on the polynomials of that
// span (which may end at t).
std::vector<Rational> exact_derivatives(const KnotVector& knots, int span, double t, int r);

}  // namespace isochor
