// Closed surfaces of revolution, exact as rational quadratics around the axis.
#pragma once

#include <utility>
#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor::testing {

// One patch about the z axis: u runs around it in four quadratic arcs, v along the profile, a
// spline with these knots and weights (none: all one) through poles (radius, height). Poles of
// radius zero are one point; the seam, and the ends of a closed profile, share their points. The
// normal points to the right of the profile, seen with the axis on the left and upwards.
PatchModel make_revolved(const KnotVector& along,
                         const std::vector<std::pair<double, double>>& profile,
                         const std::vector<double>& weights = {});

// The profile of a full circle of radius `minor` around (major, 0), run through so that normals
// point outwards: a torus.
PatchModel make_rational_torus(double major, double minor);

}  // namespace isochor::testing
