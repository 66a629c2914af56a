// Which faces of a shape cut through each other (crossings_account.h says how it is answered).
//
// Method: pairs of faces whose boxes meet are divided into cells (face_cells.h) until bounds part
// them, by boxes or by slabs along a normal. What remains is tried for a common point
// (crossing_point.h). Bounds that are not proven part nothing: such pairs are undecided.
//
// Laws (tests of those names in tests/step/self_intersections_test.cpp):
//  (1) certain: what is found is a crossing by more than four tolerances and gaps of the faces, and
//      more than kCoincident * diagonal;
//  (2) no false alarm: faces that touch, end on each other or share edges are not found;
//  (3) complete: every pair and every face is counted in one answer.
//
// Cost: at most kMostTests tests of cells for a pair and kMostTestsInAll for a shape; pairs beyond
// are undecided. Internal to the step layer (OpenCASCADE types).
#pragma once

#include "isochor/step/brep_table.h"
#include "isochor/step/crossings_account.h"
#include "isochor/step/solid_model.h"

namespace isochor::internal {

// Neighbours are compared but for points nearer than this part of the smaller face's box to what
// they share.
inline constexpr double kSharedStrip = 1.0 / 64.0;

// `edges`: measured, in the order of the table's.
CrossingsAccount self_intersections(const BrepTable& table, const std::vector<EdgeFacts>& edges);

}  // namespace isochor::internal
