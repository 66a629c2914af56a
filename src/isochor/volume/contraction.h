// The volume of closed polynomial models and its gradient by tensors on differences of poles: no
// Gauss points at run time, O(d^2) operations a pole.
//
// Symbols: patch S = sum p_ij B_i(u) B_j(v) with poles p; a_ij = iint B_i B_j (S_u x S_v) du dv is
// the vector area weighted by one basis product. On a closed model the gradient of the volume with
// respect to a point is the signed sum of a_ij over the places where patches use it, and the volume
// is the sum of z times its third component.
//   Derivatives are written on differences: S_u = sum (p_{k+1,j} - p_kj) b_k(u) B_j(v) with
// b_k = d / (t_{k+d+1} - t_{k+1}) N_{k+1,d-1}. One tensor a direction is then enough,
// tau_ikj = integral of B_i B_k b_j, and no absolute position ever enters.
//
// Laws:
//  (1) second method: equal to VolumeForm and to ExactVolume up to rounding; the error of the
//      gradient grows like the number of poles a side, not like its square as with theta tensors
//  (2) translation:   moving all points by the same vector changes no bit of the gradient where the
//      sums of coordinates are exact
//  (3) symmetry:      tau_ikj == tau_kij
//  (4) partition:     the sum of tau_ikj over i and k is the integral of b_j, 1 for clamped knots
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/volume/span_table.h"
#include "isochor/volume/volume_form.h"

namespace isochor {

// tau of one direction, stored banded with i fastest: 2d (2d + 1) n numbers.
class TauTensor {
 public:
  // By Gauss quadrature with ceil(3d/2) points per span, exact up to rounding. Cost O(n d^4).
  explicit TauTensor(const KnotVector& knots);

  int size() const { return size_; }
  int degree() const { return degree_; }
  // tau_ikj with k = i + o - d and j = i + s - d for o in [0, 2d] and s in [0, 2d - 1]: the numbers
  // for i = 0 .. size() - 1.
  const double* band(int o, int s) const {
    return &band_[(static_cast<size_t>(o) * 2 * degree_ + s) * static_cast<size_t>(size_)];
  }
  // Zero outside the band; i and k from 0 to size() - 1, j from 0 to size() - 2.
  double operator()(int i, int k, int j) const {
    const int o = k - i + degree_;
    const int s = j - i + degree_;
    if (o < 0 || o > 2 * degree_ || s < 0 || s >= 2 * degree_) return 0.0;
    return band(o, s)[i];
  }

 private:
  void add_products(const SpanTable& table, int span, int g, int c, double weight);

  int degree_;
  int size_;
  std::vector<double> band_;
};

class VolumeContraction {
 public:
  // Throws PreconditionError unless the model is closed and no patch has weights.
  explicit VolumeContraction(const PatchModel& model);

  // One row per point of the model's table. Cost per pole of equal degrees d: 3 d^2 + O(d)
  // multiplications six times over, for the value and all three columns together.
  ValueAndGradient value_and_gradient(const std::vector<Vec3>& points) const;

 private:
  struct PatchTensors {
    TauTensor u, v;
    std::vector<int> points;  // #u x #v
    double sign = 1.0;
  };
  void add_patch(const PatchTensors& patch, const std::vector<Vec3>& points,
                 std::vector<Vec3>& rows) const;

  size_t point_count_ = 0;
  std::vector<PatchTensors> patches_;
};

}  // namespace isochor
