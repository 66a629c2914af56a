// How many grid cells each knot span of each patch gets.
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor {
struct TessellationOptions;
}

namespace isochor::internal {

// One number for each non-empty span.
struct CellCounts {
  std::vector<int> u, v;
};

// From the second derivatives of every shape: a cell of width h on a curve with |c''| <= m is at
// most m h^2 / 8 away from its chord. Spans that face each other across a matching join get the
// same number.
std::vector<CellCounts> choose_cells(const PatchModel& model,
                                     const std::vector<const std::vector<Vec3>*>& shapes,
                                     const TessellationOptions& options);

}  // namespace isochor::internal
