// The integer solutions of one small system of equations, and the one near a real target.
//
// Symbols: A is m x n of integers, its rows independent; x in Z^n with x_j a multiple of
// multiplier_j; A x = s. Unimodular column operations (W. Blankinship 1963, by Euclid) bring A to
// [H 0] with H lower triangular, 0 <= H_ik < H_ii: the last n - m columns of the transformation
// are a basis of all integer solutions of A x = 0 (the lattice is saturated), the first m solve
// A x = s from w = H^-1 s, and there is an integer solution exactly when w is an integer vector.
// The basis is reduced (Lenstra, Lenstra, Lovasz 1982); a real solution is rounded to it plane by
// plane (Babai 1986). Doubles only choose integers here: every choice is an exact solution.
//
// Laws (tests/ecles/lattice_test.cpp):
//  (1) kernel:    A kernel == 0, and the basis spans every integer solution of A x = 0
//  (2) exact:     nearest() returns x with A x == s in integers, or false
//  (3) bound:     |x_j - target_j| <= bound()[j] when A target == s
//  (4) obstacle:  y^T A is an integer vector and y^T s is not: no integer x solves A x = s
#pragma once

#include <optional>
#include <vector>

#include "isochor/exact/integer_matrix.h"
#include "isochor/exact/rational.h"

namespace isochor::internal {

// Sums of products of machine words.
__extension__ typedef __int128 Wide;

// sum += a b; false, and sum unspecified, when that leaves 128 bits.
[[nodiscard]] inline bool add_product(Wide& sum, Wide a, Wide b) {
  Wide product;
  return !__builtin_mul_overflow(a, b, &product) && !__builtin_add_overflow(sum, product, &sum);
}

using IntegerVectors = std::vector<std::vector<Integer>>;

// An LLL-reduced basis of the lattice that the independent vectors span.
void reduce_basis(IntegerVectors& basis);

// Rounds to a lattice: given residual r, integers t such that r - sum t_i basis_i is small.
class NearestPlane {
 public:
  NearestPlane() = default;
  // Independent vectors whose entries fit a long.
  explicit NearestPlane(const IntegerVectors& basis);
  const std::vector<std::vector<long>>& basis() const { return basis_; }
  // Half the sum over i of |i-th orthogonalised vector|, by coordinate, with room for the rounding
  // of the doubles: where the residual of rounding ends for targets in the span.
  std::vector<double> bound() const;
  // x + combination of the basis near to the target. False when a number leaves 128 bits.
  [[nodiscard]] bool round(const std::vector<double>& target, std::vector<Wide>& x) const;
  // Takes from x what the basis can, for as long as it gets shorter.
  void shorten(std::vector<Integer>& x) const;

 private:
  std::vector<std::vector<long>> basis_;
  std::vector<std::vector<double>> orthogonal_;  // divided by their squared lengths
  std::vector<std::vector<double>> absolute_;    // the same, not divided
};

struct LatticeObstacle {
  std::vector<Rational> multipliers;  // y
  Rational value;                     // y^T s, not an integer
};

class SolutionLattice {
 public:
  // PreconditionError when rows are dependent or a multiplier is not positive.
  SolutionLattice(const IntegerMatrix& a, const std::vector<Integer>& multipliers);

  int rows() const { return static_cast<int>(hermite_.size()); }
  int columns() const { return columns_; }
  const IntegerVectors& kernel() const { return kernel_; }
  // H, whose determinant is the index of the right sides that have an integer solution.
  const IntegerVectors& hermite() const { return hermite_; }
  Integer index() const;
  // Whether every number fits a machine word; otherwise nearest() must not be called.
  bool fits() const { return fits_; }
  std::vector<double> bound() const {
    return kernel_.empty() ? std::vector<double>(static_cast<size_t>(columns_)) : rounding_.bound();
  }

  std::optional<LatticeObstacle> obstacle(const std::vector<Integer>& s) const;
  // The solution near to the target, which should nearly solve A x = s. False when there is none or
  // a number leaves 128 bits.
  [[nodiscard]] bool nearest(const std::vector<Wide>& s, const std::vector<double>& target,
                             std::vector<Wide>& x) const;

 private:
  int columns_ = 0;
  bool fits_ = false;
  IntegerVectors kernel_, particular_, hermite_;
  std::vector<std::vector<long>> particular_words_, hermite_words_;
  NearestPlane rounding_;
};

}  // namespace isochor::internal
