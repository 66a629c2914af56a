// Surfaces of revolution, exact as rational splines around the axis.
#pragma once

#include <utility>
#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor::testing {

// One patch about the z axis: u runs around it in four quadratic arcs, v along the profile, a
// spline with these knots and weights (none: all one) through poles (radius, height). Poles of
// radius zero are one point; the seam, and the ends of a closed profile, share their points. The
// normal points to the right of the profile, seen with the axis on the left and upwards.
// `circle`: arcs of degree 2 with eight poles around, of degree 3 with twelve, or of degree 2 with
// periodic knots that wrap one pole.
enum class Circle { kQuadratic, kCubic, kPeriodic };
PatchModel make_revolved(const KnotVector& along,
                         const std::vector<std::pair<double, double>>& profile,
                         const std::vector<double>& weights = {},
                         Circle circle = Circle::kQuadratic);

// A nose along z: a quarter of an ellipse from the pole at z = 0, then a cylinder of `radius`; the
// other end is open. Its tangent plane at the pole is z = 0.
PatchModel make_nose(double radius, double length, Circle circle = Circle::kQuadratic);

// The profile of a full circle of radius `minor` around (major, 0), run through so that normals
// point outwards: a torus.
PatchModel make_rational_torus(double major, double minor);

}  // namespace isochor::testing
