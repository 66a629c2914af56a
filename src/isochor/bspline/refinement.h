// Exact knot insertion: more freedom, the same shape.
//
// Symbols: degree d; coarse knots t (n functions b_j), fine knots s (m >= n functions B_i), s is t
// with further knots strictly inside the domain. b_j = sum_i M(i,j) B_i, so a fine pole is
// P_i = sum_j M(i,j) p_j, and a gradient with respect to coarse poles is M^T times the fine one.
//
// Laws:
//  (1) same shape: the spline with poles M p on s equals the spline with poles p on t;
//  (2) rows are convex: 0 <= M(i,j), sum_j M(i,j) = 1 to d roundings, at most d + 1 nonzeros;
//  (3) where s_i .. s_{i+d+1} are consecutive in t, row i is exactly a unit row, so poles that need
//      not change keep their bits;
//  (4) two insertions one after the other equal both at once.
//
// A *wrapped* vector is unclamped and its own periodic extension; poles i and i + N are then the
// same pole. Inserting near one end must then also change the knots beyond the other end: that is
// what the wrapped_ functions do. With k wrapped poles, n = N + k.
#pragma once

#include <vector>

#include "isochor/bspline/knots.h"
#include "isochor/bspline/surface.h"

namespace isochor {

// A sparse matrix whose row i has its nonzeros side by side. Immutable.
class BandedMap {
 public:
  struct Row {
    int first;  // coarse index of coefficients[0]
    int count;
    const double* coefficients;
    // True when the row copies one coarse coefficient.
    bool unit() const { return count == 1 && coefficients[0] == 1.0; }
  };

  // `rows[i]`: the first coarse index and the coefficients from there on.
  // Exact zeros at both ends of a row are dropped.
  struct RowData {
    int first;
    std::vector<double> coefficients;
  };
  BandedMap(int size_coarse, const std::vector<RowData>& rows);
  static BandedMap identity(int size);

  int size_fine() const { return static_cast<int>(first_.size()); }
  int size_coarse() const { return size_coarse_; }
  Row row(int i) const;

  // M x and M^T y, in O(#nonzeros). Sizes must fit (PreconditionError).
  std::vector<double> apply(const std::vector<double>& coarse) const;
  std::vector<Vec3> apply(const std::vector<Vec3>& coarse) const;
  std::vector<double> apply_transposed(const std::vector<double>& fine) const;
  std::vector<Vec3> apply_transposed(const std::vector<Vec3>& fine) const;

 private:
  int size_coarse_ = 0;
  std::vector<int> first_;
  std::vector<size_t> begin_;  // where row i starts in coefficients_; one more than rows
  std::vector<double> coefficients_;
};

// The same along both directions of a u-major grid: fine = Mu coarse Mv^T, and its transpose.
std::vector<Vec3> apply_to_grid(const BandedMap& u, const BandedMap& v,
                                const std::vector<Vec3>& coarse);
std::vector<Vec3> apply_transposed_to_grid(const BandedMap& u, const BandedMap& v,
                                           const std::vector<Vec3>& fine);

// The matrix M (Oslo algorithm: row i is the blossom of the coarse basis at s_{i+1} .. s_{i+d}).
// Works for clamped and unclamped vectors. PreconditionError when the degrees differ or `fine` is
// not `coarse` with knots inserted strictly inside the domain. Cost O(m d^2).
BandedMap insertion_map(const KnotVector& coarse, const KnotVector& fine);

// `knots` with further interior knots. InputError naming the value when it is not strictly inside
// the domain or its multiplicity would exceed the degree.
KnotVector with_knots(const KnotVector& knots, std::vector<double> inserted);

// The interior knots of `fine` that `coarse` lacks, ascending, with multiplicity.
// PreconditionError when the domains or degrees differ or `coarse` has a knot that `fine` lacks.
std::vector<double> inserted_knots(const KnotVector& coarse, const KnotVector& fine);

// The coarsest vector that refines both: each interior knot as often as the vector that has it
// more often. PreconditionError unless degree, domain and the knots outside of it are equal.
KnotVector common_knots(const KnotVector& a, const KnotVector& b);

// Number of poles that wrap around (pole i is pole i + n - k for i < k) if the knots are those of a
// periodic spline, to a few roundings of the period; 0 when they are not (or when clamped).
int wrapped_poles(const KnotVector& knots);

// with_knots and insertion_map for wrapped vectors (PreconditionError when not wrapped): the knots
// outside the domain follow the insertion, and rows use whichever copy of a coarse pole is near.
// The rows are right for poles that do wrap; the fine poles then wrap again, bit for bit.
KnotVector wrapped_with_knots(const KnotVector& knots, std::vector<double> inserted);
BandedMap wrapped_insertion_map(const KnotVector& coarse, const KnotVector& fine);

// The most spans that a refinement may ask for in one direction.
inline constexpr int kMaxSpans = 100000;

// Knots with at least `spans` spans of comparable length: whichever spans are longest are divided
// evenly, ties together, until there are enough. Old knots stay. Knots outside the domain stay too:
// for a wrapped vector hand inserted_knots(knots, result) to wrapped_with_knots.
KnotVector refined_to_spans(const KnotVector& knots, int spans);
// Knots whose spans are at most `length` long, each old span divided evenly. `length` must be
// positive and must not ask for more than kMaxSpans spans (InputError).
KnotVector refined_to_length(const KnotVector& knots, double length);

// The same surface on finer knots, through homogeneous coordinates when rational. Poles whose rows
// are unit rows in both directions keep their bits.
Surface refine(const Surface& surface, const KnotVector& u_knots, const KnotVector& v_knots);
// The same for maps that are known already (they may be wrapped maps).
Surface refine(const Surface& surface, const KnotVector& u_knots, const BandedMap& u_map,
               const KnotVector& v_knots, const BandedMap& v_map);

}  // namespace isochor
