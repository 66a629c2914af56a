// Cross sections of shapes with trimmed and analytic faces: section.h for any closed solid.
//
// As there, the area is minus the flux of the plane's normal through the part of the surface below
// the plane; here every face contributes by Green's theorem along its loops (contour.h), whose
// inner integrals stop at the plane (section_integrand.h).
//
// Laws (tests of those names in tests/step/solid_section_test.cpp):
//  (1) closed forms of solids with planes, cylinders, cones, spheres, tori and holes, in any pose;
//  (2) patches: a solid of whole B-spline faces has the sections of its patch model;
//  (3) |area - true| <= bound in all tested shapes (an estimate, not a proof).
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <TopoDS_Shape.hxx>
#include <gp_Trsf.hxx>
#include <optional>

#include "isochor/volume/section.h"
#include "isochor/volume/section_cells.h"

namespace isochor::internal {

// The frame of a plane near a shape.
struct ShapeFrame {
  Frame frame;
  gp_Trsf to_frame;  // a motion: parameters of surfaces, and with them loops, stay what they are
  double diagonal = 0.0;
  double noise = 0.0;            // of a height
  double low = 0.0, high = 0.0;  // heights of the shape's box, which may be larger than the shape
};
// `normal` of length one. Empty for a shape without extent.
std::optional<ShapeFrame> shape_frame(const TopoDS_Shape& shape, const Vec3& normal, double height);

// The section of a closed shape by {x : normal.x = height}. PreconditionError when the normal is
// zero or not finite. The bound is infinite when the loops of a face do not close.
Section shape_section(const TopoDS_Shape& shape, const Vec3& normal, double height);

}  // namespace isochor::internal
