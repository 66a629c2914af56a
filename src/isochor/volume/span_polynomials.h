// The basis functions of one direction as exact polynomials, span by span.
#pragma once

#include <vector>

#include "isochor/bspline/knots.h"
#include "isochor/exact/integer.h"

namespace isochor::internal {

// On the s-th non-empty span, parametrised by t in [0, 1],
//   B_{first(s) + j}(t) = sum_k coefficient(s, j, k) t^k / denominator(s),  0 <= j, k <= d.
class SpanPolynomials {
 public:
  explicit SpanPolynomials(KnotVector knots);

  const KnotVector& knots() const { return knots_; }
  int degree() const { return knots_.degree(); }
  int spans() const { return static_cast<int>(spans_.size()); }
  int first(int s) const { return knots_.spans()[static_cast<size_t>(s)] - degree(); }
  const Integer& coefficient(int s, int j, int k) const {
    return spans_[static_cast<size_t>(s)].coefficients[static_cast<size_t>(j * (degree() + 1) + k)];
  }
  const Integer& denominator(int s) const { return spans_[static_cast<size_t>(s)].denominator; }

 private:
  struct Span {
    std::vector<Integer> coefficients;
    Integer denominator;
  };
  KnotVector knots_;
  std::vector<Span> spans_;
};

}  // namespace isochor::internal
