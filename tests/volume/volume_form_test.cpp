#include "isochor/volume/volume_form.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isochor/base/error.h"
#include "support/models.h"

namespace isochor {
namespace {

using testing::make_cube_model;
using testing::random_closed_model;
using testing::RandomModelOptions;

const double kPi = std::acos(-1.0);

TEST(VolumeForm, UnitCubeOfSixBicubicPatches) {
  const PatchModel cube = make_cube_model(3, 12);
  ASSERT_EQ(cube.patches.front().u_size(), 15);
  const VolumeForm form(cube);
  EXPECT_NEAR(form.value(cube.points), 1.0, 1e-15);
}

TEST(VolumeForm, SphereAndCylinder) {
  const PatchModel sphere = testing::make_sphere(2.0);
  EXPECT_NEAR(VolumeForm(sphere).value(sphere.points), 32.0 * kPi / 3, 1e-13);
  const PatchModel cylinder = testing::make_cylinder(1.5, 4.0);
  EXPECT_NEAR(VolumeForm(cylinder).value(cylinder.points), 9.0 * kPi, 1e-13);
}

TEST(VolumeForm, Gradient) {
  RandomModelOptions options;
  options.degrees[0] = 2;
  for (double ratio : {1.0, 3.0}) {
    options.weight_ratio = ratio;
    const PatchModel model = random_closed_model(5, options);
    const VolumeForm form(model);
    const std::vector<Vec3> gradient = form.gradient(model.points);
    // V is affine in each coordinate, so a central difference is exact but for rounding.
    for (size_t i = 0; i < model.points.size(); i += 3) {
      for (int axis = 0; axis < 3; ++axis) {
        auto high = model.points;
        auto low = model.points;
        high[i][axis] += 0.5;
        low[i][axis] -= 0.5;
        EXPECT_NEAR(gradient[i][axis], form.value(high) - form.value(low), 1e-14);
      }
    }
  }
}

TEST(VolumeForm, Locality) {
  const PatchModel model = random_closed_model(6);
  const VolumeForm form(model);
  const Support support = form.support_of({7, 3, 7, 40});
  EXPECT_EQ(support.points, (std::vector<int>{3, 7, 40}));
  EXPECT_LT(support.elements.size(), form.whole().elements.size());
  auto moved = model.points;
  for (int id : support.points) moved[static_cast<size_t>(id)] += Vec3(0.1, -0.2, 0.3);
  const double global = form.value(moved) - form.value(model.points);
  EXPECT_NEAR(form.value(moved, support) - form.value(model.points, support), global, 1e-15);
  EXPECT_NEAR(form.change(model.points, moved, support), global, 1e-15);
  const auto rows = form.gradient(model.points, support);
  const auto all = form.gradient(model.points);
  for (size_t row = 0; row < rows.size(); ++row) {
    EXPECT_LT((rows[row] - all[static_cast<size_t>(support.points[row])]).norm(), 1e-16);
  }
}

}  // namespace
}  // namespace isochor
