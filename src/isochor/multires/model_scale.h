// One scale for a whole model: the same knots are kept on both sides of every matching join.
//
// Laws:
//  (1) the coarse bases of two matching sides are the same, so coarse coefficients along a join tie
//      one to one just as fine ones do;
//  (2) the result does not depend on the order of the joins;
//  (3) a direction that wraps keeps wrapping.
#pragma once

#include <utility>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/multires/two_scale.h"

namespace isochor {

// The scales of one patch.
struct PatchScale {
  TwoScale u, v;
};

// Which interior knots of a patch to keep; used by keep_knots.
struct KeptKnots {
  int patch = 0;
  std::vector<double> u, v;
};

// All knots: the identity everywhere.
std::vector<PatchScale> finest_scale(const PatchModel& model);

// keep_every on the first direction of each chain of matching joins, carried along the chain; where
// a chain meets itself reversed, the knots of both selections are kept.
// Joins are model.joins (find_joins when there are none).
std::vector<PatchScale> keep_every(const PatchModel& model, int k);

// The listed knots, carried along matching joins; directions that no list reaches keep all knots.
// InputError naming the patch when a value is not an interior knot of it, or naming both patches
// when two lists contradict each other along a join.
std::vector<PatchScale> keep_knots(const PatchModel& model, const std::vector<KeptKnots>& kept);

}  // namespace isochor
