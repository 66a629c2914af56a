// Triple products of basis functions on differences of poles, one direction of a patch.
//
// Symbols: B_i the basis functions, d their degree, t the knots. The derivative of sum f_j B_j is
// sum (f_{j+1} - f_j) b_j with b_j = d / (t_{j+d+1} - t_{j+1}) N_{j+1,d-1}, and
//   tau_ikj = integral of B_i B_k b_j,
// which vanishes unless |i - k| <= d and i - d <= j < i + d. All entries are non-negative, and no
// step of their computation cancels anything.
//
// Laws:
//  (1) symmetry:  tau_ikj == tau_kij, bit by bit
//  (2) partition: the sum of tau_ikj over i and k is the integral of b_j, 1 for clamped knots
//  (3) accuracy:  relative error of every entry <= tau_error(d) for doubles; for DoubleDouble at
//  most
//                 2^20 of its units up to degree 25
#pragma once

#include <vector>

#include "isochor/bspline/knots.h"

namespace isochor {

// Stored banded with i fastest: 2d (2d + 1) n numbers. Number is double or DoubleDouble.
template <typename Number>
class BasicTauTensor {
 public:
  // By Gauss quadrature with ceil(3d/2) points per span, exact up to rounding. Cost O(n d^4).
  explicit BasicTauTensor(const KnotVector& knots);

  int size() const { return size_; }
  int degree() const { return degree_; }
  // tau_ikj with k = i + o - d and j = i + s - d for o in [0, 2d] and s in [0, 2d - 1]: the numbers
  // for i = 0 .. size() - 1.
  const Number* band(int o, int s) const { return &band_[at(o, s)]; }
  // Zero outside the band; i and k from 0 to size() - 1, j from 0 to size() - 2.
  Number operator()(int i, int k, int j) const {
    const int o = k - i + degree_;
    const int s = j - i + degree_;
    if (o < 0 || o > 2 * degree_ || s < 0 || s >= 2 * degree_) return Number(0.0);
    return band(o, s)[i];
  }

 private:
  size_t at(int o, int s) const {
    return (static_cast<size_t>(o) * 2 * degree_ + s) * static_cast<size_t>(size_);
  }

  int degree_;
  int size_;
  std::vector<Number> band_;
};

using TauTensor = BasicTauTensor<double>;

// Law (3): three basis functions of d steps each, on nodes that are good to four roundings; one
// product a point, one sum for every point of d + 1 spans.
constexpr double tau_error(int degree) {
  return (30.0 * degree + 20.0 + 1.5 * (degree + 1.0) * (degree + 1.0)) * 0x1p-53;
}

}  // namespace isochor
