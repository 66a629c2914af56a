// Mirror images among a set of places.
#pragma once

#include <vector>

#include "isochor/base/vec3.h"

namespace isochor {

// image[i] is the index of the place at the mirror image of place i across the plane where
// coordinate `axis` is zero, or -1 when none is within `tolerance` (a length). The relation is
// symmetric: image[image[i]] == i. Among several candidates the nearest free one is taken.
// With `groups`, one for each place, images are sought in the own group first: faces cut from one
// surface have all places in common. Cost O(n log n) for places that are not crowded.
std::vector<int> mirror_images(const std::vector<Vec3>& places, int axis, double tolerance,
                               const std::vector<int>& groups = {});

}  // namespace isochor
