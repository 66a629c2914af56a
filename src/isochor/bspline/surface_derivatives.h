// A surface at points of a grid: the basis of each line of the grid is evaluated once. A detail of
// surface.h.
#pragma once

#include "isochor/bspline/basis.h"
#include "isochor/bspline/surface.h"

namespace isochor::internal {

// The basis at a one-sided limit: at a knot, kFromBelow takes the span that ends there.
BasisValues basis_at(const KnotVector& knots, double t, int order, Limit limit);

// Surface::derivatives, bit for bit, from the bases at u and at v.
SurfaceDerivatives derivatives_from(const Surface& surface, const BasisValues& bu,
                                    const BasisValues& bv, int order);

}  // namespace isochor::internal
