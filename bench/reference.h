// The volume and its gradient in 80-bit arithmetic: what errors are measured against.
//
// Sum-factorised Gauss quadrature with ceil(3d/2) points a span, all in long double, rules and
// basis functions included. Generic and unhurried: about 2 microseconds a pole at degree 3.
//
// Law (1): equal to ExactVolume up to the rounding of long double.
#pragma once

#include <array>
#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor::bench {

struct Reference {
  long double volume = 0.0L;
  std::vector<std::array<long double, 3>> gradient;  // one row per point of the model
};

// Closed polynomial models only.
Reference reference(const PatchModel& model);

// max |row - reference row| / max |reference row|, over all rows and axes.
double relative_error(const Reference& reference, const std::vector<Vec3>& gradient);

}  // namespace isochor::bench
