// Exact knot insertion before an edit: its `refine`.
//
// `auto` inserts knots around each moved point so that it becomes free, and only there. Symbols: d
// degree, r the reach: the distance from the point to the nearest trimming curve or locked side, by
// the larger of its parts along u and along v (supports are rectangles), and at most the radius of
// the extent. Spans of length h = 2 r / (d + 4) within r of the point give four functions per
// direction whose supports lie within that distance.
#pragma once

#include "isochor/bspline/patch_model.h"
#include "isochor/edit/edit_script.h"

namespace isochor {

// The model with the knots that the edit asks for, and its locks: by spans and length in the
// patches of the moves, of the extent and of the sink. The model itself without `refine`. Throws
// InputError, also where `auto` has no point of a surface to make free.
PatchModel refined_for(const PatchModel& model, const Edit& edit);

}  // namespace isochor
