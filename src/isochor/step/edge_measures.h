// How the faces at an edge fit together: gaps, angles, curvature.
//
// Symbols: along an edge, t is its tangent, n_a and n_b the outward normals of its two faces, and
// d_a = n_a x t the direction across the edge in the face.
//
// Laws:
//  (1) angles come from atan2(|n_a x n_b|, n_a . n_b): small angles keep their digits;
//  (2) the measures do not depend on the parametrisation of the faces.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include "isochor/step/brep_table.h"

namespace isochor::internal {

// All facts of an edge. Edges with one or more than two sites have no angle and are "sharp".
EdgeFacts measure_edge(const BrepTable& table, const EdgeRecord& edge);

}  // namespace isochor::internal
