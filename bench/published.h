// The contraction as published (Sauvage et al. 2008, section 4.1), the baseline of the fast one.
//
// theta_ijk = integral of B_i B_j B_k' in each direction (eq. 9, 10), banded; for each pole and
// each coordinate the double sum over the poles of its neighbourhood (eq. 7, 13). The sums are the
// paper's. The code is tuned: degree a template parameter, inner loops unrolled, tables contiguous
// in the order of use, products with zeros of the band left out, a halo of zeros instead of bounds,
// and the flags of the fast kernel with fused multiply-adds allowed everywhere.
//
// `published_method` leaves the instructions to the compiler; `published_method_simd` treats four
// neighbouring poles at once, one vector lane each: the same sums as fast as we can make them.
#pragma once

#include <memory>

#include "patch_grid.h"

namespace isochor::bench {

// Degrees 1 to 5, equal in u and v. The columns are the gradient of the integral of z dx dy: on
// closed models their sums over the places of a point are those of a_ij.
std::unique_ptr<GradientMethod> published_method(const PatchGrid& grid);
std::unique_ptr<GradientMethod> published_method_simd(const PatchGrid& grid);

}  // namespace isochor::bench
