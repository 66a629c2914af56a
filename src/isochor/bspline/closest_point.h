// The point of a surface, or of a model, that is nearest to a given point.
//
// The global minimum is looked for by sampling every element (non-empty span times span) and then
// minimising inside elements by Newton's method with bounds, moving on to the next element where a
// minimum lies on a knot line: derivatives are never taken across a crease.
//
// Laws:
//  (1) no sample of the surface is nearer than the result;
//  (2) the result is stationary to rounding: inside its element the difference is perpendicular to
//      the surface, on a border it points outwards;
//  (3) with a trim, the result lies in the kept region or on its boundary polyline.
// Not a law: the global minimum. A dent smaller than the sampling can hide a nearer point.
#pragma once

#include "isochor/bspline/patch_model.h"

namespace isochor {

struct ClosestPoint {
  int patch = -1;  // -1: nothing found (no patch, or everything trimmed away)
  Uv uv;
  Vec3 point = Vec3::Zero();
  double distance = 0.0;  // length unit
};

// `patch` of the result is 0. PreconditionError when `p` is not finite.
// Cost O(#elements * d^4) for the samples, then a few Newton runs.
ClosestPoint closest_point(const Surface& surface, const Vec3& p);
// Only the kept region counts.
ClosestPoint closest_point(const Surface& surface, const TrimRegion& trim, const Vec3& p);
// Over all patches and their trims; patches whose poles are all farther away are skipped.
ClosestPoint closest_point(const PatchModel& model, const Vec3& p);

}  // namespace isochor
