// B-spline curves and surfaces in the text of a STEP file. Internal to `step`; no OpenCASCADE.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/surface.h"
#include "isochor/step/part21.h"

namespace isochor::internal {

// A curve (one direction) or a surface (u and v).
struct SplineText {
  const Part21Instance* instance = nullptr;
  std::vector<int> degrees;
  std::vector<std::vector<double>> knots;  // with repetition; empty for kinds that state none
  std::vector<Part21Value> points;         // references, u-major
  std::vector<double> weights;             // as stated; empty unless rational
  bool bezier = false;
};

// Empty when the instance is no B-spline and no Bezier curve or surface. Throws InputError.
std::optional<SplineText> spline_text(const Part21File& file, const Part21Instance& instance);

// A curve or surface to be written.
struct SplineValue {
  std::vector<KnotVector> knots;
  std::vector<Vec3> poles;
  std::vector<double> weights;
};
SplineValue spline_value(const Surface& surface);

// Whether poles of `value` may take the place of those of `text`, one by one, and nothing else
// changes. Weights that are all equal count as none.
bool same_basis(const SplineText& text, const SplineValue& value);

// The coordinates of a CARTESIAN_POINT with three of them. Throws InputError.
Vec3 point_of(const Part21File& file, const Part21Instance& instance);

// The body of a new instance whose poles are the instances `points`.
std::string spline_body(const SplineValue& value, const std::vector<std::uint64_t>& points);

}  // namespace isochor::internal
