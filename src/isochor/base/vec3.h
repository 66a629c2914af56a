// Points and vectors of space.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products

namespace isochor {

// A point or a displacement, in the model's length unit.
using Vec3 = Eigen::Vector3d;

// A parameter pair (u, v) of a surface.
struct Uv {
  double u = 0.0;
  double v = 0.0;
  friend bool operator==(const Uv& a, const Uv& b) { return a.u == b.u && a.v == b.v; }
};

}  // namespace isochor
