// B-spline surfaces between Isochor's values and OpenCASCADE's. Internal to `step`.
//
// Laws: (1) there and back is the identity, bit for bit (weights that are all equal aside: see
// from_occt); (2) parameters mean the same point on both sides.
#pragma once

#include <Geom_BSplineSurface.hxx>
#include <TopoDS_Face.hxx>

#include "isochor/bspline/surface.h"

namespace isochor::internal {

Handle(Geom_BSplineSurface) to_occt(const Surface& surface);

// `surface` must not be periodic (PreconditionError). A surface that OpenCASCADE calls polynomial
// has no weights. Throws InputError when the knots break the law of KnotVector.
Surface from_occt(const Geom_BSplineSurface& surface);

// The surface under a face as a B-spline that is not periodic, in the surface's own coordinates,
// with the same parameters; null when it is not a B-spline or Bezier surface.
Handle(Geom_BSplineSurface) plain_bspline(const TopoDS_Face& face);

}  // namespace isochor::internal
