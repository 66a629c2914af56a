// Basis functions tabulated at the Gauss points of every non-empty span of one direction.
//
// Symbols: span s is the s-th non-empty span of the domain (an ordinal, not a knot index), g a
// Gauss point, j = 0 .. d a function of the span: B_{first(s) + j}.
//
// Laws:
//  (1) exactness: with gauss_points(s) >= ceil(3d/2), products of two functions and one derivative
//      are integrated exactly up to rounding;
//  (2) accuracy: values and slope sizes carry a relative error of at most (9d + 6) unit roundoffs,
//      slopes one of that many of their sizes,
//      however far the knots are from zero, because only knot differences are used.
#pragma once

#include <vector>

#include "isochor/bspline/knots.h"
#include "isochor/volume/gauss.h"

namespace isochor {

class SpanTable {
 public:
  SpanTable(KnotVector knots, int gauss_points);

  const KnotVector& knots() const { return knots_; }
  int degree() const { return knots_.degree(); }
  int spans() const { return static_cast<int>(knots_.spans().size()); }
  int gauss_points() const { return points_; }
  // The first function that lives on span s.
  int first(int s) const { return knots_.spans()[static_cast<size_t>(s)] - degree(); }

  // Arrays over the Gauss points of span s.
  const double* weights(int s) const { return &weights_[static_cast<size_t>(s) * points_]; }
  const double* values(int s, int j) const { return &values_[at(s, j)]; }
  const double* slopes(int s, int j) const { return &slopes_[at(s, j)]; }
  // A slope is the difference of two positive terms; this is their sum.
  const double* slope_sizes(int s, int j) const { return &slope_sizes_[at(s, j)]; }

 private:
  size_t at(int s, int j) const {
    return (static_cast<size_t>(s) * (degree() + 1) + j) * static_cast<size_t>(points_);
  }
  void tabulate(int s, const GaussRule& rule);

  KnotVector knots_;
  int points_;
  std::vector<double> weights_, values_, slopes_, slope_sizes_;
};

// The number of Gauss points per span that makes the volume of polynomial patches exact:
// z x_u y_v has degree 3d - 1 in each direction.
inline int exact_gauss_points(int degree) { return (3 * degree + 1) / 2; }

}  // namespace isochor
