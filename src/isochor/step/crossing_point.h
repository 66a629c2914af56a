// A point where two faces certainly cut through each other.
//
// Symbols: at a common point p of the faces a and b with unit normals n_a, n_b, the tangent of
// their intersection is t = n_a x n_b, and d_a = t x n_a leads across it in a. Walking a from p
// along +d_a and along -d_a leaves b to different sides.
//
// The faces *cross by* h when the walks in a reach points inside a that are farther than h from b
// on different sides of it, with foot points inside b all the way, and the same with a and b
// exchanged. A face that only touches another one, or ends on it, does not cross it.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <optional>

#include "isochor/step/face_cells.h"

namespace isochor::internal {

struct CrossingPoint {
  Uv a, b;
  Vec3 at = Vec3::Zero();
  double depth = 0.0;  // the faces cross by this, or more
};

// From the start values; nothing when the iteration does not end in a common point, when the point
// is not clearly inside both faces, or when they do not cross by more than `limit` there.
// `diagonal` of the shape.
std::optional<CrossingPoint> crossing_near(const FaceCells& face_a, Uv a, const FaceCells& face_b,
                                           Uv b, double limit, double diagonal);

}  // namespace isochor::internal
