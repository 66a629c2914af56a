#include "isochor/edit/extent_selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"
#include "support/messages.h"
#include "support/models.h"

namespace isochor {
namespace {

using ::testing::HasSubstr;

struct Fixture {
  PatchModel model;
  DisplacementSpace space;
  explicit Fixture(PatchModel m, int every = 1)
      : model([&] {
          m.joins = find_joins(m);
          return m;
        }()),
        space(model, options(every)) {}
  static DisplacementSpace::Options options(int every) {
    DisplacementSpace::Options o;
    o.scale.kind = every == 1 ? Scale::Kind::kFinest : Scale::Kind::kEvery;
    o.scale.every = every;
    return o;
  }
  int count(const Extent& extent, const std::vector<ExtentSeed>& seeds = {}) const {
    const auto mask = select_extent(model, space, extent, seeds);
    return static_cast<int>(std::count(mask.begin(), mask.end(), 1));
  }
};

TEST(ExtentSelection, RadiusOnThePaperCube) {
  // Numbers of free points within r of (0.7, 0.8) of the top, counted across the joins.
  const Fixture cube(testing::make_cube_model(3, 12));
  Extent extent;
  extent.kind = Extent::Kind::kRadius;
  const ExtentSeed seed{Vec3(0.7, 0.8, 1.0),
                        cube.space.surface_row(cube.model, 0, {0.7, 0.8}).coefficient};
  int previous = 0;
  for (double r : {0.3, 0.5, 0.8}) {
    extent.radius = r;
    int straight = 0;
    for (int c = 0; c < cube.space.size(); ++c) {
      straight += (cube.space.place(c) - seed.position).norm() <= r;
    }
    EXPECT_EQ(cube.count(extent, {seed}), straight) << r;
    EXPECT_GT(straight, previous);
    previous = straight;
  }
}

TEST(ExtentSelection, RadiusDoesNotReachThroughAThinPlate) {
  PatchModel plate = testing::make_cube_model(3, 12);
  testing::transform(plate, Vec3(1.0, 1.0, 0.01).asDiagonal());
  const Fixture thin(plate);
  Extent extent;
  extent.kind = Extent::Kind::kRadius;
  extent.radius = 0.25;
  const ExtentSeed seed{Vec3(0.5, 0.5, 0.01),
                        thin.space.surface_row(thin.model, 0, {0.5, 0.5}).coefficient};
  const auto mask = select_extent(thin.model, thin.space, extent, {seed});
  int top = 0;
  int bottom = 0;
  for (int c = 0; c < thin.space.size(); ++c) {
    if (!mask[static_cast<size_t>(c)]) continue;
    (thin.space.place(c).z() > 0.005 ? top : bottom) += 1;
  }
  EXPECT_GT(top, 9);
  EXPECT_EQ(bottom, 0);
}

TEST(ExtentSelection, RingsGrowByOneStepAcrossJoins) {
  const Fixture cube(testing::make_cube_model(2, 6));
  Extent extent;
  const ExtentSeed seed{Vec3::Zero(), {cube.space.coefficient(0, 0, 0)}};
  extent.rings = 0;
  EXPECT_EQ(cube.count(extent, {seed}), 1);
  extent.rings = 1;  // a corner of three faces: three edge neighbours and three face neighbours
  EXPECT_EQ(cube.count(extent, {seed}), 7);
  extent.rings = 100;
  EXPECT_EQ(cube.count(extent, {seed}), cube.space.size());
}

TEST(ExtentSelection, BoxLoopFacesPolesPointsAll) {
  const Fixture cube(
      testing::make_cube_model(1, 4));  // degree 1: Greville abscissae 0, 1/4, ..., 1
  Extent extent;
  extent.kind = Extent::Kind::kBox;
  extent.patch = "top";
  extent.u = {0.25, 0.75};  // closed: points exactly on the border belong to it
  extent.v = {0.0, 0.25};
  EXPECT_EQ(cube.count(extent), 6);
  extent.kind = Extent::Kind::kLoop;
  extent.loop = {{0.1, 0.1}, {0.9, 0.1}, {0.5, 0.9}};
  EXPECT_EQ(cube.count(extent), 5);
  extent.kind = Extent::Kind::kFaces;
  extent.faces = {"top", "face:2"};
  EXPECT_EQ(cube.count(extent), 50);
  extent.kind = Extent::Kind::kPoles;
  extent.poles = {{"top", {{0, 0}, {1, 1}, {1, 1}}}};
  EXPECT_EQ(cube.count(extent), 2);
  extent.kind = Extent::Kind::kPoints;
  extent.points = {0, 3};
  EXPECT_EQ(cube.count(extent), 2);
  extent.kind = Extent::Kind::kAll;
  EXPECT_EQ(cube.count(extent), cube.space.size());
}

std::string error_of(const Fixture& fixture, const Extent& extent) {
  return testing::message_of<InputError>([&] { fixture.count(extent); });
}

TEST(ExtentSelection, ThingsThatDoNotExistAreNamed) {
  const Fixture cube(testing::make_cube_model(1, 4));
  Extent extent;
  extent.kind = Extent::Kind::kPoints;
  extent.points = {100000};
  EXPECT_THAT(error_of(cube, extent), HasSubstr("no point 100000"));
  extent.kind = Extent::Kind::kPoles;
  extent.poles = {{"top", {{5, 0}}}};
  EXPECT_THAT(error_of(cube, extent), HasSubstr("[5, 0] is outside the grid of 5 x 5"));
  extent.kind = Extent::Kind::kFaces;
  extent.faces = {"roof"};
  EXPECT_THAT(error_of(cube, extent), HasSubstr("\"roof\""));
  extent.kind = Extent::Kind::kPoints;
  extent.points = {0};
  EXPECT_THAT(error_of(Fixture(testing::make_cube_model(1, 4), 2), extent), HasSubstr("finest"));
}

}  // namespace
}  // namespace isochor
