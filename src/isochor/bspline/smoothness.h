// How smooth a surface is, measured on the geometry: across a curve, across its own knot lines, and
// at a side that is collapsed into one point.
//
// Symbols: n unit normal (outward: times the patch's sign), T unit tangent of the curve that is
// crossed, kappa normal curvature in the direction n x T. When two surfaces share a curve and their
// normals along it, they have all curvatures in common as soon as kappa agrees (the curvature along
// T and the mixed term follow from the shared curve and normals).
//
// Laws:
//  (1) the measures do not depend on the parametrisation, on rotation or on shifts;
//  (2) scaling the model by s leaves angles alone and divides curvatures by s;
//  (3) a knot line is never measured rougher than what its multiplicity guarantees.
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor {

inline Direction running_direction(Side side) {
  return is_u_side(side) ? Direction::kV : Direction::kU;
}
inline Direction across_direction(Side side) {
  return is_u_side(side) ? Direction::kU : Direction::kV;
}
inline const KnotVector& knots_of(const Surface& surface, Direction direction) {
  return direction == Direction::kU ? surface.u_knots() : surface.v_knots();
}
inline const KnotVector& knots_of(const Patch& patch, Direction direction) {
  return direction == Direction::kU ? patch.u_knots : patch.v_knots;
}

// What one side of a curve looks like at one of its points.
struct CurveFrame {
  bool regular = false;  // false: the surface is singular here, nothing below is set
  Vec3 normal = Vec3::Zero();
  double curvature = 0.0;  // kappa
};

// The frame from derivatives of order 2. `tangent_is_u`: the curve runs along u. `sign` orients the
// normal, `size` is the diagonal of the model, the domain lengths make speeds comparable to it.
CurveFrame curve_frame(const SurfaceDerivatives& at, bool tangent_is_u, double sign, double size,
                       double u_length, double v_length);

// The angle between two unit vectors, accurate also near 0; radians.
double angle_between(const Vec3& a, const Vec3& b);

// The smoothness class for a largest angle (radians) and a largest curvature jump (1 / length).
Smoothness classify_smoothness(double max_angle_rad, double max_curvature_jump, double size);

// One interior knot line of a surface.
struct KnotLine {
  double knot = 0.0;
  int multiplicity = 0;
  Smoothness guaranteed = Smoothness::kSharp;  // by the basis: d - multiplicity
  Smoothness measured = Smoothness::kSharp;    // at least `guaranteed`
  double max_angle_rad = 0.0;                  // as measured; 0 when not needed
  double max_curvature_jump = 0.0;
};

// The knot lines u = const (direction kU) or v = const. Only lines whose basis does not guarantee
// curvature are measured, at several points per span. `size`: the diagonal of the model.
std::vector<KnotLine> interior_smoothness(const Surface& surface, Direction direction, double size);

// A side that is collapsed into one point.
struct PoleSide {
  bool collapsed = false;
  double spread = 0.0;         // largest distance of its poles from the first one
  double max_angle_rad = 0.0;  // of the limits of the normals to the one where the side begins
  // kTangent: one tangent plane; kAlmost: nearly; kSharp: a tip like that of a cone.
  Smoothness smoothness = Smoothness::kSharp;
};

// Collapsed means that all boundary poles coincide within kCoincident * size.
PoleSide pole_side(const Surface& surface, Side side, double size);

}  // namespace isochor
