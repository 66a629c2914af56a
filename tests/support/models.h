// Small models with known properties, for tests of every layer.
//
// All are closed and oriented outwards (positive volume) unless the comment says otherwise.
#pragma once

#include <cstdint>

#include "isochor/bspline/patch_model.h"

namespace isochor::testing {

// The unit cube of six patches that share their boundary points. Points are Greville points, so the
// faces are planar and their parametrisation is the identity. Faces and (u, v) axes: "top" z = 1
// (x, y), "bottom" z = 0 (y, x), "right" x = 1 (y, z), "left" x = 0 (z, y), "back" y = 1 (z, x),
// "front" y = 0 (x, z). Handles are "face:1" to "face:6" in this order.
PatchModel make_cube_model(int degree, int spans);
// The same with the three directions' own clamped knots over [0, 1]; degrees may differ.
PatchModel make_box_model(const KnotVector& x, const KnotVector& y, const KnotVector& z);

// A clamped knot vector over [0, 1] with random spans (lengths within a factor of about 10) and
// random interior multiplicities 1 .. degree.
KnotVector random_clamped_knots(std::uint32_t seed, int degree, int spans);

struct RandomModelOptions {
  int degrees[3] = {3, 3, 3};  // of the x, y and z directions
  int spans = 3;
  double bend = 0.15;         // largest random displacement of each coordinate; edge is 1
  double weight_ratio = 1.0;  // 1: polynomial; else weights are random in [1, weight_ratio]
};
// A bent cube: random knots, each point displaced at random. Closed whatever the displacement.
PatchModel random_closed_model(std::uint32_t seed, const RandomModelOptions& options = {});

// One open polynomial patch with random knots and points in the unit box; unclamped when asked.
PatchModel random_open_patch(std::uint32_t seed, int degree_u, int degree_v, int spans,
                             bool unclamped = false);

// A torus as one patch with unclamped uniform knots in both directions: the first and last
// `degree` rows and columns are the same points. #u and #v count the distinct points.
PatchModel make_periodic_torus(int degree_u, int degree_v, int rows, int columns,
                               double major_radius = 2.0, double minor_radius = 0.5);

// Exact surfaces of rational quadratics: a sphere as one 9 x 5 patch (seam and poles share points),
// and a closed circular cylinder along z from z = 0 of a wall and two disks.
PatchModel make_sphere(double radius);
PatchModel make_cylinder(double radius, double height);

// Separate surfaces, each with points of its own and the handle "face:<number>"; no ties, no joins.
PatchModel make_separate_model(const std::vector<Surface>& surfaces);

// Moves all points by t; sizes all points by the matrix.
void translate(PatchModel& model, const Vec3& t);
void transform(PatchModel& model, const Eigen::Matrix3d& matrix);

}  // namespace isochor::testing
