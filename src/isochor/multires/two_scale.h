// Two scales of one direction: a subset of the interior knots spans the coarse functions.
//
// Symbols: fine knots s with functions B_i, coarse knots t (a sub-multiset of s) with functions
// b_j, b_j = sum_i M(i,j) B_i. Moving coarse coefficient j by delta adds delta b_j to the shape,
// that is M delta to the fine poles; the details, which no b_j describes, stay (Sauvage et al.
// 2008, 3.2).
//
// Laws:
//  (1) a coarse gradient is M^T times the fine one;
//  (2) the published algorithm (their Appendix A, Algorithm 1) gives the same numbers;
//  (3) keeping all knots gives the identity.
//
// Knots are kept or removed with their whole multiplicity: a removed crease is not smoothed (it is
// a detail of the shape), only the displacement is smooth across it.
#pragma once

#include <vector>

#include "isochor/bspline/refinement.h"

namespace isochor {

struct TwoScale {
  KnotVector coarse;
  BandedMap map;  // coarse coefficients to fine ones
};

// Whether the poles of the direction wrap around (see refinement.h); then so do the coarse ones.
enum class Wrap { kNo, kYes };

// Keeps the distinct interior knots numbered k, 2k, 3k, ... (from 1, ascending). k = 1 keeps all.
// InputError unless k >= 1; PreconditionError when `wrap` is kYes but the knots are not wrapped.
TwoScale keep_every(const KnotVector& fine, int k, Wrap wrap = Wrap::kNo);

// Keeps the listed interior knots, in any order; repeated values count once.
// InputError naming the first value that is not an interior knot, and its neighbours.
TwoScale keep_knots(const KnotVector& fine, const std::vector<double>& kept, Wrap wrap = Wrap::kNo);

// Keeps the distinct interior knots whose flag is set, in ascending order.
TwoScale keep_flagged(const KnotVector& fine, const std::vector<bool>& kept, Wrap wrap = Wrap::kNo);

// The distinct interior knots, ascending: what keep_every numbers and keep_flagged flags.
std::vector<double> interior_breaks(const KnotVector& knots);

// Appendix A, Algorithm 1, as published: turns the entries of a gradient that belong to `fine` into
// those of `coarse`, in place, one removed knot after the other, in O(n d). (Formula (23) of the
// paper misplaces an index and two of its denominators; the algorithm has them right.)
// PreconditionError when sizes do not fit or `coarse` is not part of `fine`.
std::vector<double> remove_knots_published(const KnotVector& fine, const KnotVector& coarse,
                                           std::vector<double> gradient);
std::vector<Vec3> remove_knots_published(const KnotVector& fine, const KnotVector& coarse,
                                         std::vector<Vec3> gradient);
// The same for the gradient of a patch, u-major: first the columns, then the rows.
std::vector<Vec3> remove_knots_published(const KnotVector& fine_u, const KnotVector& coarse_u,
                                         const KnotVector& fine_v, const KnotVector& coarse_v,
                                         const std::vector<Vec3>& gradient);

}  // namespace isochor
