// Knot insertion in a model: more poles, the same shape, the same joins.
//
// Knots inserted along a matching join are inserted in the neighbour as well (mapped to its domain,
// reversed where the join is opposed), and so on along the chain; otherwise the sides would no
// longer tie one to one. New poles that are the same combination of the same points become one
// point; the same combination of tied points, tied points. That covers joins, seams, wraps and
// collapsed sides without special cases.
//
// Laws:
//  (1) every patch keeps its shape (refinement.h, law 1), and untouched poles keep point and bits;
//  (2) matching joins keep matching, shared sides stay shared, ties stay ties, wraps keep wrapping;
//  (3) patches that no chain of joins reaches are not changed at all.
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/bspline/smoothness.h"

namespace isochor {

// Finer knots asked for one patch; only knots inside the domain are looked at.
struct PatchKnots {
  int patch = 0;
  KnotVector u, v;
};

// The refined model. New points are appended to the table; points that no patch uses any more stay
// in it, so indices keep their meaning. Joins are kept with `matching` and `mismatch` brought up to
// date; trims and locked sides are kept; locks are dropped (derive_locks makes new ones).
// Joins are model.joins (find_joins when there are none). InputError when a knot cannot be inserted
// in the patch or in a neighbour that the chain reaches; PreconditionError when a vector lacks a
// knot of its patch. Cost O(#new poles * d^2 log).
PatchModel refine(const PatchModel& model, const std::vector<PatchKnots>& wanted);
PatchModel refine(const PatchModel& model, int patch, const KnotVector& u, const KnotVector& v);

// The same model without points that no patch uses (and their ties); the others keep their order.
PatchModel without_unused_points(const PatchModel& model);

}  // namespace isochor
