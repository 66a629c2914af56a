// From a B-rep to the patch model: patches, ties, joins, locked sides and locked corners.
//
// A side of a patch may move only with everything that shares it. Where both faces of an edge are
// patches and use a whole natural side there, the boundary poles tie one to one. Sides in different
// bases, and edges that are a part of a side (T-junctions), become joins in a common basis, which
// equations keep together. Everything else is locked, with a reason that names the neighbour.
//
// Laws:
//  (1) ties only connect points nearer than kCoincident * diagonal (measure_join);
//  (2) each side of each patch, edge by edge, is tied, locked, free (an edge of one face) or
//  trimmed
//      away;
//  (3) a corner that touches a face that is not a patch, or a trim inside one, is locked.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include "isochor/step/brep_table.h"

namespace isochor::internal {

// Adds the editable faces of the table as patches (and sets their `patch` numbers), then all
// relations between them. `edges`: the facts of the table's edges, in their order. `shared_trims`:
// list those too.
PatchModel patch_model(BrepTable& table, const std::vector<EdgeFacts>& edges,
                       bool shared_trims = false);

}  // namespace isochor::internal
