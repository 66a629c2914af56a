// The volume of polynomial models as a rational number.
//
// Doubles are dyadic rationals, so knots and points are exact data, and the volume, its gradient
// and the change that an edit makes are rational numbers. Nothing here rounds: this is the
// yardstick for VolumeForm and the proof behind a certificate.
//
// On each element the basis functions are polynomials in t in [0, 1] with rational coefficients
// (the volume does not depend on the parametrisation, so each span is taken as [0, 1]). With
// x = sum x_kl t^k s^l and so on, the element contributes (eq. 7 in the power basis)
//   sum z_ab y_cd x_ef (e d - c f) / ((a + c + e) (b + d + f)),
// evaluated on integers over one common denominator.
//
// Patches whose weights are all equal count as polynomial. A patch with other weights has no
// rational volume; functions that would need it throw InputError naming it. Coordinates that are
// not finite, and tables that do not fit the model, are the caller's bug (PreconditionError).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/exact/rational.h"

namespace isochor {

using ExactVec3 = std::array<Rational, 3>;

// An immutable functional, like VolumeForm; copies share their tables.
class ExactVolume {
 public:
  explicit ExactVolume(const PatchModel& model);

  // False when a patch has weights that differ: then only `change` may succeed.
  bool polynomial() const;

  // V(points). Throws InputError when not polynomial(). Cost O((du + 1)^2 (dv + 1)^2) products of
  // long integers per element: six bicubic patches of 15 x 15 points take a few tenths of a second.
  Rational value(const std::vector<Vec3>& points) const;
  // One row per point of the table: dV/dx, dV/dy, dV/dz. Same cost times ten.
  std::vector<ExactVec3> gradient(const std::vector<Vec3>& points) const;
  // V(after) - V(before). Only elements whose points differ are computed, and only those must be
  // polynomial: weights elsewhere do no harm.
  Rational change(const std::vector<Vec3>& before, const std::vector<Vec3>& after) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace isochor
