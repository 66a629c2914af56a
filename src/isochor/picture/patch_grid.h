// How one patch is cut into triangles, in its parameter rectangle.
//
// Grid lines run through every knot line, with a number of cells to each span. A knot line at which
// the patch may have a crease is there twice: its vertices then have a normal for either side.
// Cells that a trimming loop crosses are halved again and again, and the last ones are cut along
// the loop. Vertices on shared cell sides are shared, so the mesh has no cracks inside a patch.
#pragma once

#include <array>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/picture/trim_test.h"

namespace isochor::internal {

struct GridLine {
  double at = 0.0;
  Limit limit = Limit::kFromAbove;
};

struct GridVertex {
  GridLine u, v;
};

struct PatchGrid {
  std::vector<GridVertex> vertices;
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise in (u, v)
};

// The lines of one direction; cells[k] cells in the k-th non-empty span.
std::vector<GridLine> grid_lines(const KnotVector& knots, const std::vector<int>& cells);

// `levels`: how often a crossed cell is halved.
PatchGrid make_patch_grid(const std::vector<GridLine>& u_lines,
                          const std::vector<GridLine>& v_lines, const TrimTest& trim, int levels);

}  // namespace isochor::internal
