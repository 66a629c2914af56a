#include "patch_grid.h"

#include <cmath>

#include "isochor/base/error.h"
#include "support/models.h"

namespace isochor::bench {

void gather_poles(const PatchModel& model, int patch, Columns& poles) {
  const std::vector<int>& ids = model.patches[static_cast<size_t>(patch)].points;
  for (std::vector<double>& column : poles) column.resize(ids.size());
  for (size_t place = 0; place < ids.size(); ++place) {
    const Vec3& p = model.points[static_cast<size_t>(ids[place])];
    poles[0][place] = p.x();
    poles[1][place] = p.y();
    poles[2][place] = p.z();
  }
}

PatchGrid patch_grid(const PatchModel& model, int patch) {
  const Patch& from = model.patches[static_cast<size_t>(patch)];
  PatchGrid grid{from.u_knots, from.v_knots, {}};
  gather_poles(model, patch, grid.poles);
  return grid;
}

void add_rows(const Patch& patch, const Columns& areas, std::vector<Vec3>& rows) {
  const double sign = patch.sign();
  for (size_t place = 0; place < patch.points.size(); ++place) {
    rows[static_cast<size_t>(patch.points[place])] +=
        sign * Vec3(areas[0][place], areas[1][place], areas[2][place]);
  }
}

std::vector<Vec3> point_rows(const PatchModel& model, int patch, const Columns& areas) {
  std::vector<Vec3> rows(model.points.size(), Vec3::Zero());
  add_rows(model.patches[static_cast<size_t>(patch)], areas, rows);
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
