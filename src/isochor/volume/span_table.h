// Basis functions tabulated at the Gauss points of every non-empty span of one direction.
//
// Symbols: span s is the s-th non-empty span of the domain (an ordinal, not a knot index), g a
// Gauss point, j = 0 .. d a function of the span: B_{first(s) + j}. A span may be cut into *cells*
// with a Gauss rule each; the points of all its cells are one list.
//
// Laws:
//  (1) exactness: with cells of at least ceil(3d/2) points, products of two functions and one
//      derivative are integrated exactly up to rounding;
//  (2) accuracy: values, slope sizes and weights carry a relative error of at most
//      table_roundoffs(d) unit roundoffs, slopes one of that many of their sizes, however far the
//      knots are from zero: only knot differences are used, in long double.
#pragma once

#include <limits>
#include <vector>

#include "isochor/bspline/knots.h"
#include "isochor/volume/gauss.h"

namespace isochor {

// The part [begin, end] of a span that is measured from 0 to 1. Both ends are whole multiples of a
// power of two not below 2^-50, so that their differences are exact.
struct Cell {
  double begin = 0.0;
  double end = 1.0;
  int gauss_points = 0;
  friend bool operator==(const Cell& a, const Cell& b) {
    return a.begin == b.begin && a.end == b.end && a.gauss_points == b.gauss_points;
  }
};

// The cells of one span, in order, from 0 to 1 without gaps.
using SpanCells = std::vector<Cell>;

class SpanTable {
 public:
  // The same rule on every span.
  SpanTable(KnotVector knots, int gauss_points);
  // One list of cells per span. PreconditionError when they do not fit together.
  SpanTable(KnotVector knots, std::vector<SpanCells> cells);

  const KnotVector& knots() const { return knots_; }
  const std::vector<SpanCells>& cells() const { return cells_; }
  int degree() const { return knots_.degree(); }
  int spans() const { return static_cast<int>(cells_.size()); }
  // How many points span s has, and the largest such number.
  int gauss_points(int s) const {
    return static_cast<int>(start_[static_cast<size_t>(s) + 1] - start_[static_cast<size_t>(s)]);
  }
  int gauss_points() const { return most_points_; }
  // The first function that lives on span s.
  int first(int s) const { return knots_.spans()[static_cast<size_t>(s)] - degree(); }

  // Arrays over the Gauss points of span s.
  const double* weights(int s) const { return &weights_[start_[static_cast<size_t>(s)]]; }
  const double* values(int s, int j) const { return &values_[at(s, j)]; }
  const double* slopes(int s, int j) const { return &slopes_[at(s, j)]; }
  // Slopes on differences: f' = sum over j < d of (c_{j+1} - c_j) steps_j, all steps non-negative
  // and as accurate as values.
  const double* steps(int s, int j) const { return &steps_[step_at(s, j)]; }
  // A slope is the difference of two steps; this is their sum.
  const double* slope_sizes(int s, int j) const { return &slope_sizes_[at(s, j)]; }

 private:
  size_t at(int s, int j) const {
    return start_[static_cast<size_t>(s)] * static_cast<size_t>(degree() + 1) +
           static_cast<size_t>(j) * static_cast<size_t>(gauss_points(s));
  }
  size_t step_at(int s, int j) const {
    return start_[static_cast<size_t>(s)] * static_cast<size_t>(degree()) +
           static_cast<size_t>(j) * static_cast<size_t>(gauss_points(s));
  }
  void tabulate(int s, const Cell& cell, const LongGaussRule& rule, size_t offset);

  KnotVector knots_;
  std::vector<SpanCells> cells_;
  std::vector<size_t> start_;  // per span: its first point among those of all spans; one more
  int most_points_ = 0;
  std::vector<double> weights_, values_, slopes_, slope_sizes_, steps_;
};

// Law (2): one for the last rounding, and what the recursion adds in long double: 11 a level and
// the errors of the nodes. Below 2 for all degrees where long double has 64 bits.
inline double table_roundoffs(int degree) {
  constexpr double kLong = std::numeric_limits<long double>::epsilon() /
                           static_cast<long double>(std::numeric_limits<double>::epsilon());
  return 1.0 + ((11.0 + kLongGaussUnits) * degree + kLongGaussUnits + 8.0) * kLong;
}

// The number of Gauss points per span that makes the volume of polynomial patches exact:
// z x_u y_v has degree 3d - 1 in each direction.
inline int exact_gauss_points(int degree) { return (3 * degree + 1) / 2; }

}  // namespace isochor
