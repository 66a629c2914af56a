// Poles with a tangent plane: the rows that keep it. A detail of smooth_relations.h.
//
// Symbols: P0 the pole, p_1j the second row of the patches around it, A and B two of those points.
// Near the pole the surface is P0 + h sum_j b_j w_1j (p_1j - P0) + ..., so it has a tangent plane
// as long as all p_1j - P0 = alpha_j (A - P0) + beta_j (B - P0) lie in one plane. Displacements
// keep the plane when they follow the same affine map:
//     delta_1j = delta_0 + alpha_j (delta_A - delta_0) + beta_j (delta_B - delta_0).
// alpha and beta are measured, then moved within the noise so that they fulfil every equation
// between second rows (of knot lines, seams and joins that run into the pole) exactly.
//
// On a coarse grid the second row is delta_1 = delta_0 + s V d, d = c_1 - c_0, with s from the
// knots across and V along. Where p_1 = P0 + V X has a solution the rows hold with X in place of
// p_1; else no map but the constant one is at hand, and the second row moves with the pole: d = 0.
#pragma once

#include <vector>

#include "isochor/bspline/coarse_grids.h"

namespace isochor::internal {

// All poles whose second row lies in a plane within kSmoothResidual; collapsed sides that are one
// point share a relation.
std::vector<SmoothRelation> pole_relations(const PatchModel& model);

// Adds the rows of one pole. `rows`: already with those of all lines. False when alpha and beta
// cannot agree with them.
bool add_pole_rows(const PatchModel& model, const SmoothRelation& relation, int number,
                   CoarseGrids* grids, std::vector<ContinuityRow>* rows);

}  // namespace isochor::internal
