// Moment integrals of shapes with trimmed and analytic faces: moments.h by the rules of flux.h.
//
// The integrand f(r) r.N has two factors more than the flux, so the exact rules have ceil(5d/2)
// points where those have ceil(3d/2); everything else is the same.
//
// Laws (tests of those names in tests/step/solid_moments_test.cpp):
//  (1) closed forms of solids with planes, cylinders, cones, spheres, tori and holes;
//  (2) a rigid motion of the shape moves centroid and tensors along;
//  (3) patches: a solid of whole B-spline faces has the moments of its patch model.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <TopoDS_Shape.hxx>

#include "isochor/volume/moments.h"

namespace isochor::internal {

// About the middle of the shape's box. Bounds are estimates, like those of flux.h, and infinite
// when loops do not close. Meaningful for closed shapes only.
MomentIntegrals shape_moments(const TopoDS_Shape& shape);
// About this origin: of a shape closed by planes that all pass through it.
MomentIntegrals shape_moments(const TopoDS_Shape& shape, const Vec3& origin);

}  // namespace isochor::internal
