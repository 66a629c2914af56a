// A half model and its mirror image as one model.
//
// Symbols: the half has n points and m patches; point i + n and patch q + m are the images of point
// i and patch q across the plane where coordinate `axis` is zero.
//
// Laws:
//  (1) the first n points and m patches are the half's, bit for bit; the images differ in one sign;
//  (2) open sides that lie in the plane are joined to their images, their points tied;
//  (3) a half that is open in the plane only becomes a closed model.
#pragma once

#include "isochor/bspline/patch_model.h"

namespace isochor {

// Joins are measured, locks and relations derived for the whole. Points within kCoincident times
// the diagonal lie in the plane.
PatchModel mirrored_model(const PatchModel& half, int axis);

// The sides that belong to one face only: no join, no neighbour that is locked, not collapsed.
std::vector<SideRef> free_sides(const PatchModel& model);

}  // namespace isochor
