// The volume by the published tensors: the slow second method that tests and benchmarks compare
// VolumeForm with (Sauvage et al. 2008, section 4.1).
//
// Symbols: theta_ijk = integral of B_i B_j B_k' over the domain of one direction (eq. 9, 10); it
// vanishes unless |i - j|, |j - k|, |i - k| <= d.
//
// Laws:
//  (1) symmetry:  theta_ijk == theta_jik
//  (2) product:   theta_ijk + theta_jki + theta_kij == [B_i B_j B_k] at the end minus at the begin
//  (3) partition: sum over k of theta_ijk == 0
#pragma once

#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/patch_model.h"

namespace isochor {

// One direction's tensor, stored banded: n (2d + 1)^2 numbers.
class ThetaTensor {
 public:
  // By Gauss quadrature with ceil(3d/2) points per span, exact up to rounding. Cost O(n d^4).
  explicit ThetaTensor(const KnotVector& knots);

  int size() const { return size_; }
  int degree() const { return degree_; }
  // Zero outside the band; indices from 0 to size() - 1.
  double operator()(int i, int j, int k) const {
    const int dj = j - i + degree_;
    const int dk = k - i + degree_;
    const int width = 2 * degree_ + 1;
    if (dj < 0 || dj >= width || dk < 0 || dk >= width) return 0.0;
    return band_[(static_cast<size_t>(i) * width + dj) * width + dk];
  }

 private:
  int degree_;
  int size_;
  std::vector<double> band_;
};

// V by eq. 5 and 7. Polynomial patches only: PreconditionError when a patch has weights.
// Cost O(n (2d + 1)^4) per patch of n points with equal degrees. Rounding grows with the square of
// the number of points along a side, because absolute positions enter: use it on small models.
double theta_volume(const PatchModel& model, const std::vector<Vec3>& points);

// All three gradient columns; the first is eq. 13, the others by the same contraction of eq. 7.
std::vector<Vec3> theta_gradient(const PatchModel& model, const std::vector<Vec3>& points);

}  // namespace isochor
