// Parallel projection: from space to pixels and depth.
//
// Symbols: (right, up, toward) is a right-handed orthonormal frame, `toward` points from the scene
// to the eye. Pixel (0, 0) is the top left corner of the picture, y runs downwards. Depth grows
// towards the eye, in the model's length unit.
#pragma once

#include <vector>

#include "isochor/io/mesh.h"

namespace isochor {

struct Camera {
  Vec3 right = Vec3::UnitX(), up = Vec3::UnitY(), toward = Vec3::UnitZ();
  Vec3 centre = Vec3::Zero();  // is seen in the middle of the picture
  double scale = 1.0;          // pixels per length unit
  int width = 0, height = 0;   // pixels

  // (x, y, depth).
  Vec3 project(const Vec3& p) const {
    const Vec3 d = p - centre;
    return {0.5 * width + scale * right.dot(d), 0.5 * height - scale * up.dot(d), toward.dot(d)};
  }
};

// The frame that looks against `toward` with `axis` upright in the picture.
Camera look_along(const Vec3& toward, const Vec3& axis);

// The half-turned view from the front, the right and above (for `axis` up) that designers expect.
Vec3 three_quarter_view(const Vec3& axis);

// The direction to the eye, among a fixed set near the three-quarter view, that shows `focus` best:
// it faces the viewer, but not flatly, and nothing in `mesh` stands before it.
// Cost: O(#triangles * #candidates).
Vec3 view_of_focus(const Mesh& mesh, const Vec3& focus, const Vec3& normal, const Vec3& axis);

// What the points cover in the directions right and up of a camera (its scale is not used).
struct Frame2d {
  double right_min = 0.0, right_max = 0.0, up_min = 0.0, up_max = 0.0;
  double width() const { return right_max - right_min; }
  double height() const { return up_max - up_min; }
};
Frame2d covered(const Camera& camera, const std::vector<Vec3>& points);

// Centre and scale so that `frame` fills a picture of that size but for `margin` pixels around.
Camera fit(Camera camera, const Frame2d& frame, int width, int height, double margin);

}  // namespace isochor
