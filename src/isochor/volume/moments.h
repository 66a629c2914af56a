// Volume, centroid, second moments and inertia of a closed model, and their derivatives.
//
// Symbols: body B, patch q with sign s_q, N = S_u x S_v, origin c near the body, r = S - c.
// The ten *moment integrals* are M_f = integral of f(x - c) over B for the monomials
//   f = 1, x, y, z, xx, xy, xz, yy, yz, zz                                   (in this order).
// A monomial of degree k is homogeneous, so div(f(r) r) = (k + 3) f(r), and Gauss's theorem gives
//   M_f = 1 / (k + 3)  sum_q s_q iint f(r) r.N du dv.
// One integrand r.N serves all ten; it turns with the body, and c keeps it accurate anywhere.
// When the points move by dp_i the boundary moves by phi_i dp_i, so dM_f/dp_i = iint f(r) phi_i N.
//
// From these, with V = M_1: centroid g = c + M_x / V; second moments about the centroid
// C_ij = M_ij - M_i M_j / V; inertia J = trace(C) I - C, density one; its eigenvalues and axes.
// `moments` and `gradients` measure from the centroid itself (found by a first pass).
//
// Everything here needs a closed model (see closure in bspline/joins.h); on an open one the numbers
// depend on c and mean nothing. Reversing every patch negates volume, second moments and inertia.
//
// Laws (tests in tests/volume/moments_test.cpp and moments_exact_test.cpp):
//  (1) translation: centroid moves along, everything else stays;   (2) rotation: tensors turn
//  along; (3) scaling: by a, a^3 for the volume, a for the centroid, a^5 for the tensors; (4)
//  parallel axes: integrals about any origin give the same centroid and tensors; (5) closed forms:
//  affine boxes, sphere, ellipsoid, cylinder, cone, torus; (6) bound: |value - exact| <= bound,
//  proven for polynomial patches but for principal moments; (7) gradient: rows are the derivatives,
//  by central differences; moving all points is (1).
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/volume/volume_form.h"

namespace isochor {

using Matrix3 = Eigen::Matrix3d;

// How many monomials of degree two or less there are in three variables.
inline constexpr size_t kMomentCount = 10;
using MomentArray = std::array<double, kMomentCount>;

// The values of the ten monomials at r.
MomentArray monomials(const Vec3& r);

// The ten integrals about an origin. Units: length^3, length^4, length^5.
struct MomentIntegrals {
  Vec3 origin = Vec3::Zero();
  MomentArray value{};
  MomentArray bound{};  // of |value - exact|
};

// What the integrals say about the body; every bound is for the entry at the same place.
struct Moments {
  Bounded volume;                                                    // length^3
  Vec3 centroid = Vec3::Zero(), centroid_bound = Vec3::Zero();       // length
  Matrix3 second = Matrix3::Zero(), second_bound = Matrix3::Zero();  // about the centroid, length^5
  Matrix3 inertia = Matrix3::Zero(), inertia_bound = Matrix3::Zero();  // the same
  // Eigenvalues of the inertia, ascending, and one bound for all (Weyl's inequality).
  Vec3 principal = Vec3::Zero();
  double principal_bound = 0.0;
  // Column k: the unit axis of principal[k], right-handed, the largest entries of the first two
  // positive. axis_bound[k]: the largest angle to the true axis in radians; pi / 2 when
  // neighbouring moments are too close to tell their axes apart, as on bodies of revolution.
  Matrix3 axes = Matrix3::Identity();
  Vec3 axis_bound = Vec3::Zero();
};

// InputError when the volume is not different from zero beyond its bound: no centroid then.
Moments moments_from(const MomentIntegrals& integrals);

// Derivatives with respect to the points: row i belongs to point i of the model's table and is
// (d/dx_i, d/dy_i, d/dz_i), added up over all patches that use the point.
struct MomentGradients {
  std::vector<Vec3> volume;                   // length^2
  std::array<std::vector<Vec3>, 3> centroid;  // of g_x, g_y, g_z; no unit
  // Of C_xx, C_xy, C_xz, C_yy, C_yz, C_zz about the (moving) centroid, length^4.
  std::array<std::vector<Vec3>, 6> second;
};

// An immutable functional of the points; copies share their tables. Thread-safe.
//
// Rules: x_i x_j r.N has degree 5d - 1 in each direction, so ceil(5d/2) Gauss points a span are
// exact on polynomial patches. Patches with weights get, once, in the constructor, as many as it
// takes until a finer rule changes nothing but rounding, at most 64.
class MomentForm {
 public:
  // Uses knots, weights and orientation of the patches; points only to choose rules for weights.
  explicit MomentForm(const PatchModel& model);

  int point_count() const;
  std::pair<int, int> gauss_points(int patch) const;

  // Bounds: polynomial patches, proven (rounding). Patches with weights: twice the distance to the
  // next finer rule and a rounding count not proven in its constants; an estimate.
  // Cost: two evaluations of every Gauss point; with weights, about four.
  MomentIntegrals integrals(const std::vector<Vec3>& points, const Vec3& origin) const;

  // InputError as moments_from.
  Moments moments(const std::vector<Vec3>& points) const;
  MomentGradients gradients(const std::vector<Vec3>& points) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace isochor
