#include "patch_grid.h"

#include <cmath>

#include "isochor/base/error.h"
#include "support/models.h"

namespace isochor::bench {

PatchGrid patch_grid(const PatchModel& model, int patch) {
  const Patch& from = model.patches[static_cast<size_t>(patch)];
  PatchGrid grid{from.u_knots, from.v_knots, {}};
  for (size_t axis = 0; axis < 3; ++axis) {
    std::vector<double>& column = grid.poles[axis];
    column.reserve(from.points.size());
    for (int id : from.points) {
      column.push_back(model.points[static_cast<size_t>(id)][static_cast<int>(axis)]);
    }
  }
  return grid;
}

std::vector<Vec3> point_rows(const PatchModel& model, int patch, const Columns& areas) {
  const Patch& from = model.patches[static_cast<size_t>(patch)];
  std::vector<Vec3> rows(model.points.size(), Vec3::Zero());
  for (size_t place = 0; place < from.points.size(); ++place) {
    rows[static_cast<size_t>(from.points[place])] +=
        from.sign() * Vec3(areas[0][place], areas[1][place], areas[2][place]);
  }
  return rows;
}

PatchModel wavy_torus(int degree, int side) {
  ISOCHOR_REQUIRE(side > 2 * degree, side, degree);
  PatchModel model =
      testing::make_periodic_torus(degree, degree, side - degree, side - degree, 2.0, 0.7);
  for (Vec3& p : model.points) {
    p += 0.05 * Vec3(std::sin(3.0 * p.y() + p.z()), std::sin(2.0 * p.z() - p.x()),
                     std::sin(4.0 * p.x() + 2.0 * p.y()));
  }
  return model;
}

PatchModel bent_cube(int degree, int side, int ripples) {
  ISOCHOR_REQUIRE(side > degree, side, degree);
  PatchModel model = testing::make_cube_model(degree, side - degree);
  const double waves = 2.0 * std::acos(-1.0) * ripples;
  for (Vec3& p : model.points) {
    p += 0.01 * Vec3(std::sin(waves * p.y()) * std::sin(waves * p.z()),
                     std::sin(waves * p.z()) * std::sin(waves * p.x()),
                     std::sin(waves * p.x()) * std::sin(waves * p.y()));
    p += 0.1 * Vec3(std::sin(3.0 * p.y() + p.z()), std::sin(2.0 * p.z() - p.x()),
                    std::sin(4.0 * p.x() + 2.0 * p.y()));
  }
  return model;
}

}  // namespace isochor::bench
