// Places along an edge that two patches share as a trimming curve. Internal to `step`.
#pragma once

#include <array>

#include "isochor/bspline/patch_model.h"
#include "isochor/step/brep_table.h"

namespace isochor::internal {

// Fills `along` and `boxes`; nothing for a face that has no parameter curve of the edge. Places at
// equal fractions of both parameter curves, dense enough to see every wave of either surface.
void trace_shared_trim(const BrepTable& table, const std::array<EdgeSite, 2>& sites,
                       SharedTrim& trim);

}  // namespace isochor::internal
