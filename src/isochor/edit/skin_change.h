// What an edit did to the smoothness of a skin: angles and curvatures before and after, measured.
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor {

// The largest changes over the places where the surface was smoother than its points have to be.
struct SkinChange {
  int joins = 0;       // smooth joins of patches that moved
  int knot_lines = 0;  // smooth knot lines that would allow a crease, of patches that moved
  int poles = 0;       // collapsed sides with a tangent plane
  double angle_rad = 0.0;
  // Of the jump of the normal curvature, 1 / length unit; where curvature was continuous and the
  // degrees have room to keep it so.
  double curvature = 0.0;
};

// `after` is `before` with other points; only patches with moved[q] are measured. Angles by atan2
// of cross and dot products at several points of each span. Cost O(#spans d^2) of those patches.
SkinChange skin_change(const PatchModel& before, const PatchModel& after,
                       const std::vector<bool>& moved);

}  // namespace isochor
