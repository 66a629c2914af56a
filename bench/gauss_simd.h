// Our own sum-factorised Gauss quadrature, vectorised: the best known method besides contraction.
//
// ceil(3d/2) points a span and direction. For each row of elements and each Gauss point in u, the
// poles are contracted along u; then, for four elements side by side (one vector lane each), along
// v at every Gauss point; the products S_u x S_v go back the same way. All weights are folded into
// tables. 9 n (d + 1) + n^2 (9 d + 15) fused multiply-adds a pole for n points: 1230 at degree 3.
#pragma once

#include <memory>

#include "patch_grid.h"

namespace isochor::bench {

// Degrees 1 to 5, equal in u and v; interior knots simple. The columns are a_ij.
std::unique_ptr<GradientMethod> gauss_method(const PatchGrid& grid);

}  // namespace isochor::bench
