// Cells cut by a waterline, for below.h: integrals below it and what they may miss.
#pragma once

#include <array>
#include <vector>

#include "isochor/volume/compensated_sum.h"
#include "isochor/volume/flux_field.h"
#include "isochor/volume/section_cells.h"

namespace isochor::internal {

// Those of the closing planes whose caps may lie below: a cap is inside the box of the body.
std::vector<ClosingPlane> caps_below(const ClosingPlane& plane,
                                     const std::vector<ClosingPlane>& closing, const Vec3& low,
                                     const Vec3& high);

// The field in the frame of a plane, in which Z = 0 is the waterline.
struct FrameField {
  Vec3 slope = Vec3::UnitZ(), direction = Vec3::UnitZ();
  double level = 0.0;
  bool on_waterline = true;  // T = slope.z() Z
  double lever = 1.0;        // of the size of the body: what first moments are compared by

  double at(const Vec3& x) const { return slope.dot(x) - level; }
};
FrameField in_frame(const FluxField& field, const Frame& frame);

// Of T b . N and of the components of (x - T b / 2) T b . N.
using BelowLanes = std::array<double, 4>;
// Adds the field's lanes at a point with normal N = S_u x S_v.
BelowLanes lanes_at(const FrameField& field, const Vec3& at, const Vec3& normal);

// The integrals over {Z < 0} of all cells of a model, and their errors.
class BelowSums {
 public:
  // `noise`: of a coordinate. `negligible`: a volume that one cell may miss.
  BelowSums(const FrameField& field, double noise, double negligible)
      : field_(field), noise_(noise), negligible_(negligible) {}

  void add(const BezierCell& cell, double sign) { add(cell, sign, 0); }
  double value(size_t k) const { return sums_[k].total(); }
  double error(size_t k) const { return errors_[k] + rounding_[k]; }
  bool any_above() const { return any_above_; }
  bool any_below() const { return any_below_; }
  bool proven() const { return proven_; }

 private:
  struct Strip;  // a cut of a cell, ready to be added
  void add(const BezierCell& cell, double sign, int divisions);
  void add_undecided(const BezierCell& cell);
  // False, and nothing added, when the strips miss too much and the cell can be divided.
  bool add_cut(const BezierCell& cell, double sign, bool divisible);
  Strip cut(const BezierCell& cell, double from, double to) const;
  // Between u = `begin` and `end` of lines v = const from `from` to `to`: Bernstein coefficients.
  void add_region(const BezierCell& cell, double from, double to, const std::vector<double>& begin,
                  const std::vector<double>& end, double sign);
  void add_error(double volume, double lever);

  FrameField field_;
  double noise_, negligible_;
  int budget_ = 60000;  // of divisions: seconds, not minutes
  std::array<CompensatedSum, 4> sums_;
  std::array<double, 4> errors_{}, rounding_{};
  bool any_above_ = false, any_below_ = false, proven_ = true;
};

// The cell over [a, b] x [c, d] in its own parameters; ends outside [0, 1] continue it.
BezierCell part_of_cell(const BezierCell& cell, double a, double b, double c, double d);
// The Bernstein coefficients of w Z along u = r(v): of degree u_degree * (r.size() - 1) + v_degree.
std::vector<double> heights_along(const BezierCell& cell, const std::vector<double>& r);

}  // namespace isochor::internal
