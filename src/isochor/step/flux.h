// The integral of z dx dy over an oriented, trimmed face, by Green's theorem.
//
// Symbols: F(u, v) = (z - z0)(x_u y_v - x_v y_u); Q(u, v) = integral of F(s, v) ds from a fixed
// u = a. Then the integral of F over the kept region is the integral of Q dv along its loops.
// Q is integrated by Gauss rules per knot span; the loops by Gauss rules on the pieces between the
// knots of the curve and its crossings with the knot lines of the surface. With polynomial surfaces
// and curves all rules are exact; else pieces are halved until they agree.
//
// Laws (tests of those names in tests/step/flux_test.cpp):
//  (1) closed shapes: the sum over all faces does not depend on z0 and is the volume enclosed;
//  (2) a hole is subtracted: face with hole + the face that fills the hole == face without;
//  (3) reversing a face negates its flux and projected area, not its area;
//  (4) |flux - true value| <= bound in all tested shapes (an estimate, not a proof).
// With a field (volume/flux_field.h) all of this holds for its frame: z is slope . x - level, and
// dx dy the area seen along its direction.
// OpenCASCADE's own default volume is wrong by up to 8 % on B-spline solids: never compare with it.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <optional>
#include <vector>

#include "isochor/step/face_loops.h"
#include "isochor/step/trim_region.h"

namespace isochor::internal {

// Units: length^3 for flux and bound, length^2 for the areas.
struct FaceIntegrals {
  double flux = 0.0;       // of (z - z0) dx dy
  double projected = 0.0;  // of dx dy
  double area = 0.0;       // by the same rules: some six digits on curved faces
  double bound = 0.0;      // estimated error of flux; infinite when the boundary is not closed
  double projected_bound = 0.0;

  // The integral of z dx dy, and an estimate of its error.
  double flux_about_zero(double z0) const { return flux + z0 * projected; }
  double bound_about_zero(double z0) const;
};

// Integrates one face of a shape. Pass the same z0 for all faces of a shape, best its middle.
// `distance` as in classify_trim: faces that use their whole surface are integrated over it
// exactly, not along curves that follow its sides within a tolerance.
FaceIntegrals integrate_face(const TopoDS_Face& face, double z0, double distance,
                             const FluxField& field = {});

// The same for parts that are at hand. `surface` carries the location of the face.
FaceIntegrals integrate_face(const Handle(Geom_Surface) & surface,
                             const std::vector<FaceLoop>& loops, TrimKind kind, bool reversed,
                             double z0, const FluxField& field = {});

// The volume of all faces of a shape, added up, and what a common origin is worth.
struct ShapeIntegrals {
  double volume = 0.0, bound = 0.0, area = 0.0;
  double z0 = 0.0;                   // the middle of the shape's box; zero with closing planes
  std::vector<FaceIntegrals> faces;  // as often as they occur, in the order of TopExp_Explorer
};
// `field`: that of the planes which close the shape; the volume is then the closed body's.
ShapeIntegrals integrate_shape(const TopoDS_Shape& shape,
                               const std::optional<FluxField>& field = {});

}  // namespace isochor::internal
