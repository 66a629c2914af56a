// Which coefficients an extent selects.
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/edit/displacement_space.h"
#include "isochor/edit/edit_script.h"

namespace isochor {

// A moved place: where it is, and the coefficients that move it.
struct ExtentSeed {
  Vec3 position = Vec3::Zero();
  std::vector<int> coefficients;
};

// One flag per coefficient; locked coefficients may be among the selected ones.
//
// rings n: the seeds' coefficients and n steps of `neighbours` from them. radius r: coefficients
// whose place lies within r of a seed and is reached from it along the net by a path no longer than
// kPathSlack * r, so that the other skin of a thin wing is left alone. loop, box: Greville
// abscissae inside the closed curve or box. Cost O(#coefficients log #coefficients).
//
// Throws InputError for names, point ids and grid indices that do not exist.
std::vector<char> select_extent(const PatchModel& model, const DisplacementSpace& space,
                                const Extent& extent, const std::vector<ExtentSeed>& seeds);

}  // namespace isochor
