// What solids with trimmed and analytic faces have below a plane: volume/below.h for any shape that
// is closed, or closed by planes.
//
// As solid_section.h, with the flux of a field that has none through the waterline and the closing
// planes.
//
// Laws (tests of those names in tests/step/solid_below_test.cpp):
//  (1) closed forms of solids with planes, cylinders, cones, spheres, tori and holes, in any pose;
//  (2) patches: a solid of whole B-spline faces has what its patch model has;
//  (3) |volume - true| <= bound in all tested shapes (an estimate, not a proof).
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <TopoDS_Shape.hxx>

#include "isochor/volume/below.h"

namespace isochor::internal {

// InputError when no field suits the planes. The bound is infinite when the loops of a face do not
// close.
PartBelow shape_below(const TopoDS_Shape& shape, const ClosingPlane& plane,
                      const std::vector<ClosingPlane>& closing = {});

}  // namespace isochor::internal
