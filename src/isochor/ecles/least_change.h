// The nearest solution: hints changed as little as the constraints allow.
//
// Symbols (Rodrigues 2017, ch. 9): D derived parameters with hints h and weights w > 0, A the given
// independent rows on D, b their right sides once the anchors and the fixed parameters are
// substituted. The result minimises sum w_j (x_j - h_j)^2 subject to A x = b:
//     x = h + U A^T y,   (A U A^T) y = b - A h,   U = diag(1 / w).
// Rows that share no derived parameter do not meet, so every connected block is a system of its
// own; a derived parameter of no row keeps its hint. One object serves every edit of a selection
// and every component; it copies what it needs, so its cost follows the selection.
//
// Laws (tests/ecles/least_change_test.cpp):
//  (1) feasible:   solve(): every given row holds exactly
//  (2) stationary: solve(): W (x - h) is a combination of the rows, exactly; hence the optimum
//  (3) untouched:  a derived parameter of no row returns its hint bit for bit
//  (4) enclosed:   approximate(): the largest exact residual lies in the enclosure it reports
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "isochor/ecles/constraint_matrix.h"
#include "isochor/exact/rational.h"

namespace isochor {

class LeastChange {
 public:
  // `rows` independent on `derived` (a basis of the relevant rows); `weights` in the order of
  // `derived`, empty for all equal. PreconditionError for weights that are not positive or of the
  // wrong number, parameters named twice, and, when solved, dependent rows.
  LeastChange(const ConstraintMatrix& matrix, std::vector<int> derived, std::vector<int> rows,
              const std::vector<Rational>& weights = {});

  const std::vector<int>& derived() const;
  const std::vector<int>& rows() const;
  // The number of blocks with rows.
  int blocks() const;

  // One component. `right_sides`: by row of the matrix, as given (before scale()); `values`: by
  // parameter, anchors new, derived their hints. Only entries of the rows and of `derived` are
  // read. Returns values of derived(), exact.
  std::vector<Rational> solve(const std::vector<Rational>& right_sides,
                              const std::vector<Rational>& values) const;
  // The same, or nothing when a block of more than `most_eliminated` rows defeats lifting: its
  // dense solution takes minutes from two thousand rows on.
  std::optional<std::vector<Rational>> solve_within(int most_eliminated,
                                                    const std::vector<Rational>& right_sides,
                                                    const std::vector<Rational>& values) const;
  // Bounds from above of the binary digits of exact denominators, of the longest and of all
  // together: Hadamard's for the determinant of A U A^T of each block, shared by its columns. The
  // time of solve() grows with the square of the longest.
  struct Digits {
    double longest = 0.0;
    double together = 0.0;
  };
  Digits most_digits() const;

  struct Approximation {
    std::vector<double> derived;
    // The largest |residual| of the rows as given, at the doubles returned: exactly between these.
    Enclosure residual;
    // The largest change by the last refinement, plus one rounding of the largest value: the
    // distance to the optimum wherever refinement at least halves the error. An estimate.
    double last_change = 0.0;
  };
  // The same in doubles: the factor of each block, refined twice with residuals in twice the
  // precision. Blocks whose factor does not exist are solved exactly and rounded.
  Approximation approximate(const std::vector<double>& right_sides,
                            const std::vector<double>& values) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace isochor
