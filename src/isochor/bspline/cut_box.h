// A box of parameters cut out of a surface: the surface of the box alone, with the same parameters.
//
// Laws:
//  (1) same shape: the result at (u, v) is the surface at (u, v) inside the box, to rounding of the
//      poles (the matrices are rational, see common_basis.h);
//  (2) a direction that the box covers keeps its knots and, alone, its poles: clamped, unclamped or
//      wrapped;
//  (3) a direction that is cut gets clamped knots: box ends, and the interior knots between them.
#pragma once

#include "isochor/bspline/patch_model.h"
#include "isochor/bspline/surface.h"

namespace isochor {

// PreconditionError unless the box lies in the domain and is not empty.
Surface cut_box(const Surface& surface, const UvBox& box);

}  // namespace isochor
