// Sum-factorised evaluation and integration on one element (a rectangle of two knot spans).
//
// Symbols: blocks hold (du + 1)(dv + 1) coefficients, u-major; grids hold nu x nv numbers, one per
// pair of Gauss points, u-major.
#pragma once

#include <vector>

#include "isochor/volume/span_table.h"

namespace isochor::internal {

// A scalar function and its partial derivatives at the Gauss points of an element.
struct Grid {
  std::vector<double> value, du, dv;
  void resize(size_t count) {
    value.resize(count);
    du.resize(count);
    dv.resize(count);
  }
};

// A block and its differences to the next row, du x (dv + 1), and column, (du + 1) x dv.
// With non-negative numbers in all three, what `evaluate` makes of them is a majorant of what it
// makes of smaller ones.
struct Coefficients {
  std::vector<double> value, u_step, v_step;
};

class ElementKernel {
 public:
  ElementKernel(const SpanTable& u, const SpanTable& v);

  size_t block_size() const { return static_cast<size_t>(u_->degree() + 1) * (v_->degree() + 1); }
  // The number of Gauss points of element (su, sv).
  size_t grid_size(int su, int sv) const {
    return static_cast<size_t>(u_->gauss_points(su)) * static_cast<size_t>(v_->gauss_points(sv));
  }

  // Fills in the differences of block.value.
  void difference(Coefficients& block) const;
  // The function sum_ij block_ij B_i B_j on element (su, sv), its derivatives by the differences.
  // Cost O(n (d+1)(d+1+n)).
  void evaluate(int su, int sv, const Coefficients& block, Grid& out);

  // block_ij += sum over Gauss points of (a.value B_i B_j + a.du B_i' B_j + a.dv B_i B_j'):
  // the transpose of `evaluate` after `difference`.
  void accumulate(int su, int sv, const Grid& a, std::vector<double>& block);

  // The product of the quadrature weights at each Gauss point.
  void weights(int su, int sv, std::vector<double>& out) const;

 private:
  const SpanTable* u_;
  const SpanTable* v_;
  std::vector<double> rows_, row_slopes_;  // (du + 1) x nv, contracted along v
  std::vector<double> row_steps_;          // du x nv, the same with differences along u
};

}  // namespace isochor::internal
