// Systems S y = r with a sparse, symmetric, positive definite integer matrix S, solved exactly.
//
// S is factored once in doubles, after scaling by powers of two to a unit diagonal. An exact
// solution is lifted from that factor: solve in doubles, keep 50 bits, subtract their exact
// contribution from the right side, repeat (Z. Wan, "An algorithm to solve integer linear systems
// exactly using numerical methods", J. Symbolic Computation 41, 2006). The digits become fractions
// by continued fractions, and S y == r is checked in integers before anything is returned. Small
// systems, and those whose factor gains no digits, are eliminated without fractions instead
// (E. Bareiss 1968), large ones of these by the dense exact solver: slower, always right.
//
// Laws (tests/ecles/positive_system_test.cpp):
//  (1) exact:   S numerators == denominator r, denominator > 0, in lowest terms together
//  (2) ladder:  elimination and lifting give the same fractions
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "isochor/exact/integer.h"

namespace isochor::internal {

// Rows of (column, entry), columns ascending.
using SparseIntegerRows = std::vector<std::vector<std::pair<int, Integer>>>;

// numerators[j] / denominator, gcd of all of them 1.
struct CommonFractions {
  std::vector<Integer> numerators;
  Integer denominator = 1;
};

class PositiveSystem {
 public:
  enum class Rung { kEither, kElimination, kLifting };

  // `rows`: both triangles. Positive definiteness is the caller's promise; solve() throws
  // PreconditionError where elimination meets a pivot that is not positive.
  explicit PositiveSystem(SparseIntegerRows rows);

  int size() const;
  // The exact solution. kLifting returns nothing where lifting fails; the others always answer.
  std::optional<CommonFractions> solve(const std::vector<Integer>& right,
                                       Rung rung = Rung::kEither) const;

  // Whether the double factor exists. Scaled unknowns: y_j = 2^-exponent(j) times the j-th result
  // of solve_scaled, whose right side is 2^-exponent(i) r_i.
  bool factored() const;
  int exponent(int i) const;
  std::vector<double> solve_scaled(const std::vector<double>& right) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace isochor::internal
