// How smooth the interior knot lines of all patches are, measured once for relations and locks. A
// detail of continuity.h.
#pragma once

#include <array>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/bspline/smoothness.h"

namespace isochor::internal {

// Of each patch the lines u = const, then those v = const.
using MeasuredLines = std::vector<std::array<std::vector<KnotLine>, 2>>;

inline const std::vector<KnotLine>& lines_of(const MeasuredLines& lines, int q,
                                             Direction direction) {
  return lines[static_cast<size_t>(q)][direction == Direction::kU ? 0 : 1];
}

MeasuredLines measured_lines(const PatchModel& model);

// As smooth_relations(model), from lines measured before.
std::vector<SmoothRelation> smooth_relations(const PatchModel& model, const MeasuredLines& lines);

}  // namespace isochor::internal
