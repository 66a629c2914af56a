// The integrals over one element that make up the volume, its gradient and its changes.
//
// Every function works in two ways, after `fields.sizes()`: on the functions themselves, or on
// majorants, where all terms are non-negative and differences become sums. The rounding error of
// the first is at most rounding_factor times the second.
#pragma once

#include <array>
#include <vector>

#include "isochor/volume/element_fields.h"

namespace isochor::internal {

// The coordinate functions on the placed element. x and y are taken relative to a point in the
// middle of the element's block, z relative to `height`: only derivatives of x and y matter, and
// those lose nothing then, however far the model is from the origin.
void evaluate_points(ElementFields& fields, const std::vector<Vec3>& points, double height,
                     VectorGrid& out);
// The same for displacements: relative to zero.
void evaluate_directions(ElementFields& fields, const std::vector<Vec3>& directions,
                         VectorGrid& out);

// The integral of z (x_u y_v - x_v y_u).
double element_value(const ElementFields& fields, const VectorGrid& p);
// Coefficients of s, s^2, s^3 of element_value at p + s d.
std::array<double, 3> element_line(const ElementFields& fields, const VectorGrid& p,
                                   const VectorGrid& d);
// The integrands of the three gradient columns, as factors of a function and its two derivatives,
// ready for ElementFields::project.
void gradient_integrands(const ElementFields& fields, const VectorGrid& p, VectorGrid& out);

// What quadrature on the placed element may miss of the integral of (z - height) (x_u y_v - x_v
// y_u), rounding apart, and of its change when the points move by `directions`. Zero without
// weights.
double value_remainder(const ElementFields& fields, const std::vector<Vec3>& points, double height);
double change_remainder(const ElementFields& fields, const std::vector<Vec3>& points, double height,
                        const std::vector<Vec3>& directions);

// |computed - exact quadrature| <= rounding_factor(patch) * majorant, for element_value and the sum
// of the element_line terms. Counted step by step in docs/volume.md, "Rounding".
double rounding_factor(const PatchForm& patch);

}  // namespace isochor::internal
