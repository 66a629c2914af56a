// What a body has below a plane: volume and centroid (of a hull: displacement and centre of
// buoyancy), with bounds.
//
// Symbols: waterline plane n.x = h, |n| = 1; Z = n.x - h; closing planes (flux_field.h) as for the
// volume of open models. F = T b, T = c.x - c0, b.c = 1, is a field with div F = 1 that has no flux
// through the closing planes and the waterline, so the volume below is the flux of F through the
// part of the skin with Z < 0, and the first moments are that of (x - T b / 2) T b. No cap is made.
// Where b crosses the waterline, T is proportional to Z: mistakes of the waterline then count only
// by their square.
//
// Elements are Bezier cells (section_cells.h). Cells above add nothing, cells below a Gauss rule.
// A cell that is crossed and in which Z grows or falls along one parameter is cut along a
// polynomial r(v) near the waterline, up to which a Gauss rule is exact; what lies between the two
// is bounded by the residual of Z on r, from its Bernstein coefficients, over the slope of Z around
// it. Cells are halved until that is negligible; what stays undecided is in the bound.
//
// Laws (tests in tests/volume/below_test.cpp):
//  (1) closed forms: boxes, balls, cylinders, the Wigley hull, in any pose; (2) halves: below n.x =
//  h and below -n.x = -h are the whole; (3) refinement: inserting knots changes nothing; (4) |value
//  - true| <= bound. For patches without weights nothing but the count of roundings is an estimate
//  ("proven"); for those with weights the rules are judged by finer ones.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/volume/flux_field.h"

namespace isochor {

enum class PlaneSide { kCut, kEverything, kNothing };  // what of the skin lies below

struct PartBelow {
  Vec3 normal = Vec3::UnitZ();
  double height = 0.0;
  PlaneSide side = PlaneSide::kNothing;
  double volume = 0.0;  // length^3, signed like the volume of the model
  double bound = 0.0;
  Vec3 centroid = Vec3::Zero();  // zero when the volume may vanish
  double centroid_bound = 0.0;   // of its distance; infinite when the volume may vanish
  bool proven = false;           // all quadrature is exact or enclosed
};

// As parse_closing_plane, but with the side that is below: "0,0,-1,-2" is above z = 2.
ClosingPlane parse_waterline(const std::string& text);

// The field for what is below the plane in a body closed by others. Planes parallel to the
// waterline and not below it do not matter: their caps are above. Empty when there is none.
std::optional<FluxField> field_below(const ClosingPlane& plane,
                                     const std::vector<ClosingPlane>& closing);
// The same; an InputError says why there is none.
FluxField require_field_below(const ClosingPlane& plane, const std::vector<ClosingPlane>& closing);

// The part of a closed model, or of one closed by these planes, with plane.normal . x <
// plane.offset. InputError when no field suits the planes. Cost: some microseconds an element, a
// hundred times that where the waterline runs.
PartBelow part_below(const PatchModel& model, const ClosingPlane& plane,
                     const std::vector<ClosingPlane>& closing = {});

// Volume and centroid from the flux and the first moments about `origin`, with their bounds.
void set_centroid(const Vec3& first, const Vec3& first_bound, const Vec3& origin, PartBelow& part);

}  // namespace isochor
