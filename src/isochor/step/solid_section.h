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

#include "isochor/volume/section.h"

namespace isochor::internal {

// The section of a closed shape by {x : normal.x = height}. PreconditionError when the normal is
// zero or not finite. The bound is infinite when the loops of a face do not close.
Section shape_section(const TopoDS_Shape& shape, const Vec3& normal, double height);

}  // namespace isochor::internal
