#include "isochor/volume/rim.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "isochor/volume/exact_volume.h"
#include "isochor/volume/quadrature_choice.h"
#include "support/models.h"

namespace isochor::internal {
namespace {

Rim rim_of(const PatchModel& model) {
  TableCache tables;
  std::vector<PatchForm> forms;
  for (const Patch& patch : model.patches) {
    forms.push_back({tables.get(patch.u_knots, exact_gauss_points(patch.u_knots.degree())),
                     tables.get(patch.v_knots, exact_gauss_points(patch.v_knots.degree())),
                     patch.points, patch.weights, patch.sign()});
  }
  return Rim(model, forms, 0.0);
}

// The same surface with u running the other way, and the orientation flag put right.
void reverse_u(Patch& patch) {
  const std::vector<int> old = patch.points;
  const auto columns = static_cast<size_t>(patch.v_size());
  const auto rows = static_cast<size_t>(patch.u_size());
  for (size_t k = 0; k < old.size(); ++k) {
    patch.points[k] = old[(rows - 1 - k / columns) * columns + k % columns];
  }
  std::vector<double> knots = patch.u_knots.knots();
  std::reverse(knots.begin(), knots.end());
  for (double& t : knots) t = 3.0 - 2.0 * t;
  patch.u_knots = KnotVector(patch.u_knots.degree(), knots);
  patch.reversed = !patch.reversed;
}

TEST(Rim, ClosedModelsHaveNone) {
  testing::RandomModelOptions options;
  options.degrees[1] = 2;
  options.weight_ratio = 2.0;
  for (const PatchModel& model :
       {testing::make_cube_model(3, 4), testing::random_closed_model(81, options),
        testing::make_sphere(1.0), testing::make_cylinder(1.0, 2.0),
        testing::make_periodic_torus(3, 2, 5, 6)}) {
    EXPECT_TRUE(rim_of(model).elements().empty()) << model.patches[0].name;
  }
}

TEST(Rim, SidesMayRunBackwardsAndOnOtherDomains) {
  PatchModel cube = testing::make_cube_model(2, 4);  // knots k/4: reversal is exact
  for (size_t q : {0u, 3u}) reverse_u(cube.patches[q]);
  EXPECT_TRUE(rim_of(cube).elements().empty());
  EXPECT_EQ(ExactVolume(cube).value(cube.points),
            ExactVolume(testing::make_cube_model(2, 4)).value(cube.points));
}

TEST(Rim, WhatDoesNotCancelRemains) {
  PatchModel open = testing::make_cube_model(2, 4);
  open.patches.pop_back();
  EXPECT_EQ(rim_of(open).elements().size(), 4u * 4u);

  PatchModel flipped = testing::make_cube_model(2, 4);
  flipped.patches[0].reversed = true;  // its four edges are used twice in the same sense
  EXPECT_EQ(rim_of(flipped).elements().size(), 8u * 4u);

  PatchModel weighted = testing::make_cube_model(2, 4);
  Patch& patch = weighted.patches[2];
  patch.weights.assign(patch.points.size(), 1.0);
  patch.weights[1] = 2.0;  // the curve of one side changes, on this side of the edge only
  EXPECT_EQ(rim_of(weighted).elements().size(), 2u * 4u);

  PatchModel knots = testing::make_cube_model(2, 4);
  std::vector<double> other = knots.patches[4].u_knots.knots();
  other[3] = 0.2500001;
  knots.patches[4].u_knots = KnotVector(2, other);
  EXPECT_EQ(rim_of(knots).elements().size(), 4u * 4u);
}

TEST(Rim, AreaIsTheProjectedArea) {
  // By the exact volume: lifting everything by one raises the integral of z dx dy by the area.
  for (const bool unclamped : {false, true}) {
    PatchModel sheet = testing::random_open_patch(82, 3, 2, 3, unclamped);
    sheet.patches[0].reversed = unclamped;
    for (Vec3& p : sheet.points) p = (p * 4096.0).array().round() / 4096.0;
    const ExactVolume exact(sheet);
    auto lifted = sheet.points;
    for (Vec3& p : lifted) p.z() += 1.0;
    const Rational area = exact.value(lifted) - exact.value(sheet.points);
    const Rim rim = rim_of(sheet);
    const double computed = rim.area(sheet.points, rim.elements());
    const double bound = rim.rounding_factor() * rim.area(sheet.points, rim.elements(), true);
    EXPECT_LE((Rational(computed) - area).abs().to_double(), bound);
    EXPECT_LT(bound, 1e-12);
    EXPECT_GT(std::abs(computed), 1e-3);
  }
}

TEST(Rim, ElementsOfAPoint) {
  const PatchModel sheet = testing::random_open_patch(83, 2, 2, 4);
  const Rim rim = rim_of(sheet);
  std::vector<int> row_of(sheet.points.size(), -1);
  EXPECT_TRUE(rim.elements_of(row_of).empty());
  const Patch& patch = sheet.patches[0];
  row_of[static_cast<size_t>(patch.point(2, 2))] = 0;
  EXPECT_TRUE(rim.elements_of(row_of).empty());
  row_of[static_cast<size_t>(patch.point(0, 0))] = 1;
  EXPECT_EQ(rim.elements_of(row_of).size(), 2u);
}

}  // namespace
}  // namespace isochor::internal
