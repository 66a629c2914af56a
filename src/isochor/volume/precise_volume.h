// The volume of polynomial patches in twice the precision of double, with a proven bound.
//
// The tensors on differences (tau_tensor.h) contracted for the one column that the volume needs, in
// plain loops over DoubleDouble: the same sums as VolumeContraction, written to be read. The bound
// comes from the same sums over absolute values. What is left of it after rounding to double is
// hardly more than that last rounding, which is known, too: the low part.
//
// Laws (tests/volume/precise_volume_test.cpp):
//  (1) bound:  |value - exact volume| <= bound, against ExactVolume
//  (2) local:  the change that a move makes needs the elements under the moved points only
#pragma once

#include <array>
#include <vector>

#include "isochor/base/double_double.h"
#include "isochor/base/vec3.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/volume/bounded.h"

namespace isochor {

struct PreciseNumber {
  DoubleDouble value;
  double bound = 0.0;  // of the distance to the exact number

  // As a double; the bound then covers its rounding.
  Bounded rounded() const;
};

// The integral of z dx dy over one patch with poles taken from `points`, times the patch's sign.
// Polynomial patches only: PreconditionError when weights differ. Cost: some 2 us a pole of a
// bicubic patch.
PreciseNumber precise_flux(const Patch& patch, const std::vector<Vec3>& points);

// The change of precise_flux when the points go from `before` to `after`, computed on the smallest
// rectangle of elements that feels it.
PreciseNumber precise_flux_change(const Patch& patch, const std::vector<Vec3>& before,
                                  const std::vector<Vec3>& after);

// Sums; the bounds cover the additions.
PreciseNumber operator+(const PreciseNumber& a, const PreciseNumber& b);
PreciseNumber operator-(const PreciseNumber& a, const PreciseNumber& b);

// The rows (iint phi_i (S_u x S_v)) of one patch, sign included, in twice the precision: what tests
// and benchmarks measure gradients with. One row per pole, u-major.
std::vector<std::array<DoubleDouble, 3>> precise_areas(const Patch& patch,
                                                       const std::vector<Vec3>& points);

// The sum of the absolute values of all terms of the contraction for the integral of
// (z - height) dx dy over one patch, rounded up: what the rounding errors of VolumeContraction
// scale with.
double contraction_majorant(const Patch& patch, const std::vector<Vec3>& points, double height);

}  // namespace isochor
