// The volume by the published tensors: the slow second method that tests and benchmarks compare the
// others with (Sauvage et al. 2008, section 4.1), in double and exactly.
//
// Symbols: theta_ijk = integral of B_i B_j B_k' over the domain of one direction (eq. 9, 10); it
// vanishes unless |i - j|, |j - k|, |i - k| <= d, and only that band is stored.
//
// Laws:
//  (1) symmetry:  theta_ijk == theta_jik
//  (2) product:   theta_ijk + theta_jki + theta_kij == [B_i B_j B_k] at the end minus at the begin
//  (3) partition: sum over k of theta_ijk == 0
//  (4) bound:     |theta_bounded_volume - exact_theta_volume| <= bound
#pragma once

#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/exact/rational.h"
#include "isochor/volume/bounded.h"
#include "isochor/volume/exact_volume.h"

namespace isochor {

// One direction's tensor: n (2d + 1)^2 numbers, double or Rational.
template <typename Number>
class BasicThetaTensor {
 public:
  // In double: by Gauss quadrature with ceil(3d/2) points per span, exact up to rounding, cost
  // O(n d^4). In rationals: by products of exact polynomials, O(n d^5) long multiplications.
  explicit BasicThetaTensor(const KnotVector& knots);

  int size() const { return size_; }
  int degree() const { return degree_; }
  // Zero outside the band; indices from 0 to size() - 1.
  Number operator()(int i, int j, int k) const {
    const int dj = j - i + degree_;
    const int dk = k - i + degree_;
    const int width = 2 * degree_ + 1;
    if (dj < 0 || dj >= width || dk < 0 || dk >= width) return Number(0);
    return band_[(static_cast<size_t>(i) * width + dj) * width + dk];
  }

 protected:
  BasicThetaTensor(const KnotVector& knots, bool sizes);

 private:
  int degree_;
  int size_;
  std::vector<Number> band_;
};

using ThetaTensor = BasicThetaTensor<double>;
using ExactThetaTensor = BasicThetaTensor<Rational>;

// V by eq. 5 and 7. Polynomial patches only: PreconditionError when a patch has weights.
// Cost O(n (2d + 1)^4) per patch of n points with equal degrees. Rounding grows with the square of
// the number of points along a side, because absolute positions enter: use it on small models.
double theta_volume(const PatchModel& model, const std::vector<Vec3>& points);
// The same with a bound of its rounding error, counted as in docs/volume.md, "Rounding".
Bounded theta_bounded_volume(const PatchModel& model, const std::vector<Vec3>& points);
// The same sums in rationals.
Rational exact_theta_volume(const PatchModel& model, const std::vector<Vec3>& points);

// All three gradient columns; the first is Theta_YZ of eq. 13, the others by the same contraction
// of eq. 7.
std::vector<Vec3> theta_gradient(const PatchModel& model, const std::vector<Vec3>& points);
std::vector<ExactVec3> exact_theta_gradient(const PatchModel& model,
                                            const std::vector<Vec3>& points);

}  // namespace isochor
