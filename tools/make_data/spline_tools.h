// Spline constructions the bundled models are made of; all of them exact up to rounding.
//
// A pcurve is a curve in the parameter plane of a surface. Composing a bicubic piece of surface
// with a parabolic pcurve gives a space curve of degree 12: no approximation is needed anywhere.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "isochor/bspline/surface.h"

namespace make_data {

using isochor::KnotVector;
using isochor::Surface;
using isochor::Uv;
using isochor::Vec3;

// A clamped space curve; its parameter range is the domain of its knots.
struct Curve {
  KnotVector knots;
  std::vector<Vec3> poles;
};

// A function of one variable with its derivatives at the two ends of the interval of interest.
struct Profile {
  std::function<double(double)> value;
  double begin_slope = 0.0, end_slope = 0.0;
};

// The coefficients of the cubic spline over the clamped, simple knots that takes the profile's
// values at all breaks and its slopes at both ends.
std::vector<double> complete_spline(const KnotVector& knots, const Profile& profile);

// The nearest multiple of `step` (a power of two, or a power of ten given as its reciprocal).
double round_to_step(double value, double step);
double round_to_reciprocal(double value, double reciprocal);

// The boundary curve on a side of the surface, in the side's own parameter.
Curve side_curve(const Surface& surface, isochor::Side side);

// The curve u = const between v0 < v1 (or v = const between u0 < u1), in the surface's parameter.
Curve iso_u_curve(const Surface& surface, double u, double v0, double v1);
Curve iso_v_curve(const Surface& surface, double v, double u0, double u1);

// The image of the parabola with Bezier points p0, p1, p2 as a Bezier curve of degree 12 over
// [0, 1]. p1 is one of the other two corners of the box spanned by p0 and p2, and no knot lies
// inside the box. The surface is bicubic and not rational.
Curve corner_curve(const Surface& surface, Uv p0, Uv p1, Uv p2);

}  // namespace make_data
