#include "isochor/bspline/smoothness.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/surface_derivatives.h"

namespace isochor {
namespace {

double length_of(const KnotVector& knots) { return knots.end() - knots.begin(); }

// Points per span where smoothness is measured, as fractions of the span.
constexpr double kFractions[] = {0.0, 0.25, 0.5, 0.75, 1.0};

SurfaceDerivatives derivatives_at(const Surface& surface, Direction across, double knot,
                                  Limit knot_limit, double along, Limit along_limit) {
  return across == Direction::kU ? surface.derivatives(knot, along, 2, knot_limit, along_limit)
                                 : surface.derivatives(along, knot, 2, along_limit, knot_limit);
}

// The basis along lines where they are measured: at several points of each span.
std::vector<BasisValues> bases_along(const KnotVector& along) {
  std::vector<BasisValues> bases;
  for (int k : along.spans()) {
    for (double f : kFractions) {
      const double t = f == 1.0 ? along[k + 1] : along[k] + f * (along[k + 1] - along[k]);
      bases.push_back(
          internal::basis_at(along, t, 2, f == 1.0 ? Limit::kFromBelow : Limit::kFromAbove));
    }
  }
  return bases;
}

void measure_line(const Surface& surface, Direction across, const std::vector<BasisValues>& along,
                  double size, KnotLine* line) {
  const bool tangent_is_u = across == Direction::kV;
  const KnotVector& knots = knots_of(surface, across);
  const BasisValues sides[2] = {internal::basis_at(knots, line->knot, 2, Limit::kFromBelow),
                                internal::basis_at(knots, line->knot, 2, Limit::kFromAbove)};
  const double u_length = length_of(surface.u_knots());
  const double v_length = length_of(surface.v_knots());
  for (const BasisValues& at : along) {
    const auto frame = [&](const BasisValues& side) {
      return curve_frame(internal::derivatives_from(surface, tangent_is_u ? at : side,
                                                    tangent_is_u ? side : at, 2),
                         tangent_is_u, 1.0, size, u_length, v_length);
    };
    const CurveFrame below = frame(sides[0]);
    const CurveFrame above = frame(sides[1]);
    if (!below.regular || !above.regular) continue;
    line->max_angle_rad = std::max(line->max_angle_rad, angle_between(below.normal, above.normal));
    line->max_curvature_jump =
        std::max(line->max_curvature_jump, std::abs(below.curvature - above.curvature));
  }
}

}  // namespace

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

CurveFrame curve_frame(const SurfaceDerivatives& at, bool tangent_is_u, double sign, double size,
                       double u_length, double v_length) {
  CurveFrame frame;
  const double speed_u = at.su.norm();
  const double speed_v = at.sv.norm();
  const Vec3 cross = at.su.cross(at.sv);
  const double area = cross.norm();
  if (!(speed_u * u_length > kSingular * size) || !(speed_v * v_length > kSingular * size) ||
      !(area > kSingular * speed_u * speed_v)) {
    return frame;
  }
  frame.regular = true;
  frame.normal = cross * (sign / area);
  const Vec3 tangent = tangent_is_u ? Vec3(at.su / speed_u) : Vec3(at.sv / speed_v);
  const Vec3 direction = frame.normal.cross(tangent);
  // direction = a S_u + b S_v, by Cramer's rule in the tangent plane.
  const Vec3 plane_normal = cross / (area * area);
  const double a = direction.cross(at.sv).dot(plane_normal);
  const double b = at.su.cross(direction).dot(plane_normal);
  frame.curvature = a * a * at.suu.dot(frame.normal) + 2.0 * a * b * at.suv.dot(frame.normal) +
                    b * b * at.svv.dot(frame.normal);
  return frame;
}

Smoothness classify_smoothness(double max_angle_rad, double max_curvature_jump, double size) {
  if (!(max_angle_rad <= kAlmostSmoothAngle)) return Smoothness::kSharp;
  if (!(max_angle_rad <= kSmoothAngle)) return Smoothness::kAlmost;
  return max_curvature_jump * size <= kSameCurvature ? Smoothness::kCurvature
                                                     : Smoothness::kTangent;
}

std::vector<KnotLine> interior_smoothness(const Surface& surface, Direction direction,
                                          double size) {
  const KnotVector& knots = knots_of(surface, direction);
  std::vector<KnotLine> lines;
  std::vector<BasisValues> along;  // filled when it is needed
  for (double knot : knots.breaks()) {
    if (knot == knots.begin() || knot == knots.end()) continue;
    KnotLine line;
    line.knot = knot;
    line.multiplicity = knots.multiplicity(knot);
    const int order = knots.degree() - line.multiplicity;
    line.guaranteed = order >= 2   ? Smoothness::kCurvature
                      : order == 1 ? Smoothness::kTangent
                                   : Smoothness::kSharp;
    if (order >= 2) {
      line.measured = Smoothness::kCurvature;
    } else {
      if (along.empty()) {
        along = bases_along(
            knots_of(surface, direction == Direction::kU ? Direction::kV : Direction::kU));
      }
      measure_line(surface, direction, along, size, &line);
      line.measured = std::max(
          line.guaranteed, classify_smoothness(line.max_angle_rad, line.max_curvature_jump, size));
    }
    lines.push_back(line);
  }
  return lines;
}

PoleSide pole_side(const Surface& surface, Side side, double size) {
  PoleSide pole;
  const bool u_side = is_u_side(side);
  const int count = u_side ? surface.v_size() : surface.u_size();
  const int row = is_begin_side(side) ? 0 : (u_side ? surface.u_size() : surface.v_size()) - 1;
  const Vec3& first = u_side ? surface.pole(row, 0) : surface.pole(0, row);
  for (int k = 0; k < count; ++k) {
    const Vec3& p = u_side ? surface.pole(row, k) : surface.pole(k, row);
    pole.spread = std::max(pole.spread, (p - first).norm());
  }
  const KnotVector& across = knots_of(surface, across_direction(side));
  const bool clamped = is_begin_side(side) ? across.clamped_begin() : across.clamped_end();
  pole.collapsed = clamped && pole.spread <= kCoincident * size;
  if (!pole.collapsed) return pole;

  // Near the pole S = P + h D(t) + ..., so the normal tends to D'(t) x D(t).
  const KnotVector& along = knots_of(surface, running_direction(side));
  const double at_pole = is_begin_side(side) ? across.begin() : across.end();
  std::vector<Vec3> normals;
  for (int k : along.spans()) {
    for (double f : kFractions) {
      const double t = f == 1.0 ? along[k + 1] : along[k] + f * (along[k + 1] - along[k]);
      const Limit limit = f == 1.0 ? Limit::kFromBelow : Limit::kFromAbove;
      const SurfaceDerivatives d =
          derivatives_at(surface, across_direction(side), at_pole, Limit::kFromAbove, t, limit);
      const Vec3 cross = d.suv.cross(u_side ? d.su : d.sv);
      const double scale = d.suv.norm() * (u_side ? d.su : d.sv).norm();
      if (scale > 0.0 && cross.norm() > kSingular * scale) normals.push_back(cross.normalized());
    }
  }
  for (const Vec3& n : normals) {
    pole.max_angle_rad = std::max(pole.max_angle_rad, angle_between(n, normals.front()));
  }
  // The pole's curvature is not measured: a tangent plane is what editing has to keep. Where even
  // the directions vanish nothing can be said, and the pole counts as worth protecting.
  pole.smoothness = normals.empty() ? Smoothness::kAlmost
                                    : std::min(Smoothness::kTangent,
                                               classify_smoothness(pole.max_angle_rad, 0.0, size));
  return pole;
}

}  // namespace isochor
