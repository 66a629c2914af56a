// The rim of a model: the sides of patches that no other side cancels.
//
// The projected area A = sum s_q iint (x_u y_v - x_v y_u) is, by Green's theorem, the integral of
// x dy around the patches, so it depends on their sides only, and two sides that carry the same
// curve in opposite senses cancel. What remains is the rim; a closed model has none.
//
// VolumeForm measures z from a height h near the model, V = integral of (z - h) dx dy + h A. With A
// taken over the rim, a closed model far from the origin loses no accuracy, and an open model keeps
// the meaning of its volume.
//
// Sides cancel only when they are *identical*: the same points, equal weights, and knots that are
// equal after an exact affine (perhaps reversing) change of parameter. Everything else is summed.
#pragma once

#include <array>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/volume/element_fields.h"

namespace isochor::internal {

// One span of one remaining side, as a curve with its own few coefficients.
struct RimElement {
  int curve = 0;
  int span = 0;
};

class Rim {
 public:
  Rim() = default;
  // `forms` are the patches' tables, in the model's order. x is measured from `x_origin`.
  Rim(const PatchModel& model, const std::vector<PatchForm>& forms, double x_origin);

  // All elements of the rim.
  std::vector<RimElement> elements() const;
  // Those on which a point with row_of[point] >= 0 acts.
  std::vector<RimElement> elements_of(const std::vector<int>& row_of) const;

  // The rim's integral of x dy over the elements; with `sizes`, its majorant.
  double area(const std::vector<Vec3>& points, const std::vector<RimElement>& elements,
              bool sizes = false) const;
  // Coefficients of s and s^2 of area(points + s directions).
  std::array<double, 2> area_line(const std::vector<Vec3>& points,
                                  const std::vector<Vec3>& directions,
                                  const std::vector<RimElement>& elements,
                                  bool sizes = false) const;
  // rows[row_of[i]] += scale d area / d point i, for rows that exist (only x and y are touched).
  void add_area_gradient(const std::vector<Vec3>& points, const std::vector<RimElement>& elements,
                         const std::vector<int>& row_of, double scale,
                         std::vector<Vec3>& rows) const;
  // rows[row_of[i]] += the integrals of phi_i (z - height) dy and -phi_i (z - height) dx around the
  // rim in x and y, for rows that exist: what the gradient of the integral of (z - height) dx dy
  // has beside the vector areas of the patches.
  void add_flux_gradient(const std::vector<Vec3>& points, const std::vector<RimElement>& elements,
                         const std::vector<int>& row_of, double height,
                         std::vector<Vec3>& rows) const;
  // |computed - quadrature| <= rounding_factor() * majorant.
  double rounding_factor() const { return rounding_factor_; }
  // What the quadrature of area, and of the sum of area_line, may miss, rounding apart: only sides
  // with weights miss anything.
  double area_remainder(const std::vector<Vec3>& points,
                        const std::vector<RimElement>& elements) const;
  double change_remainder(const std::vector<Vec3>& points, const std::vector<Vec3>& directions,
                          const std::vector<RimElement>& elements) const;

 private:
  // A coefficient of a curve: sum of share * point, its weight included.
  struct Share {
    int point;
    double factor;
  };
  struct Curve {
    std::shared_ptr<const SpanTable> table;
    std::vector<std::vector<Share>> coefficients;
    std::vector<double> weights;     // sum of the shares' factors, or empty
    std::vector<double> remainders;  // per span, over r_x r_y; empty without weights
    double sign = 1.0;
  };
  // The largest distance of an element's points from `origin` in x and from their middle in y.
  std::array<double, 2> radii(const RimElement& at, const std::vector<Vec3>& vectors,
                              double origin) const;
  struct Values {
    std::vector<double> value, slope;
  };
  void evaluate(const RimElement& at, const std::vector<Vec3>& vectors, int axis, double origin,
                bool sizes, Values& out) const;

  std::vector<Curve> curves_;
  double x_origin_ = 0.0;
  double rounding_factor_ = 0.0;
};

}  // namespace isochor::internal
