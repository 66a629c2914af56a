#include "isochor/picture/camera.h"

#include <gtest/gtest.h>

#include "io/meshes.h"
#include "isochor/base/error.h"

namespace isochor {
namespace {

TEST(Camera, FrameIsRightHandedWithTheAxisUpright) {
  for (const Vec3& toward : {Vec3(1, -2, 1), Vec3(-3, 0.1, -1), Vec3(0, 0, 1)}) {
    const Camera camera = look_along(toward, Vec3::UnitZ());
    EXPECT_LT((camera.right.cross(camera.up) - camera.toward).norm(), 1e-14);
    EXPECT_NEAR(camera.right.norm(), 1.0, 1e-14);
    EXPECT_NEAR(camera.right.z(), 0.0, 1e-14) << "the axis does not lean";
    EXPECT_GE(camera.up.z(), -1e-14);
  }
}

TEST(Camera, ProjectionIsRightUpAndTowards) {
  Camera camera = look_along(-Vec3::UnitY(), Vec3::UnitZ());
  camera.width = 100, camera.height = 60, camera.scale = 10.0;
  camera.centre = Vec3(1, 1, 1);
  EXPECT_LT((camera.project({1, 1, 1}) - Vec3(50, 30, 0)).norm(), 1e-12);
  EXPECT_LT((camera.project({2, 1, 1}) - Vec3(60, 30, 0)).norm(), 1e-12);
  EXPECT_LT((camera.project({1, 1, 2}) - Vec3(50, 20, 0)).norm(), 1e-12);
  EXPECT_LT((camera.project({1, 0, 1}) - Vec3(50, 30, 1)).norm(), 1e-12);
}

TEST(Camera, FitShowsEverythingAndFillsOneDirection) {
  const Mesh box = testing::box_mesh(9, 1, 1);
  const Camera direction = look_along(three_quarter_view(Vec3::UnitZ()), Vec3::UnitZ());
  const Camera camera = fit(direction, covered(direction, box.positions), 300, 200, 12.0);
  double low = 1e9, high = -1e9;
  for (const Vec3& p : box.positions) {
    const Vec3 at = camera.project(p);
    low = std::min(low, at.x()), high = std::max(high, at.x());
    EXPECT_GE(at.y(), 12.0 - 1e-9);
    EXPECT_LE(at.y(), 188.0 + 1e-9);
  }
  EXPECT_NEAR(low, 12.0, 1e-9);
  EXPECT_NEAR(high, 288.0, 1e-9);
}

TEST(Camera, FitOfASinglePointIsUsable) {
  const Camera direction = look_along(Vec3::UnitX(), Vec3::UnitZ());
  const Camera camera = fit(direction, covered(direction, {Vec3(1, 2, 3)}), 50, 50, 5.0);
  EXPECT_EQ(camera.scale, 1.0);
  EXPECT_NEAR(camera.project({1, 2, 3}).x(), 25.0, 1e-12);
}

TEST(Camera, ThreeQuarterViewIsFromTheFrontRightAndAbove) {
  const Vec3 toward = three_quarter_view(Vec3::UnitZ());
  EXPECT_GT(toward.x(), 0.0);
  EXPECT_LT(toward.y(), 0.0);
  EXPECT_GT(toward.z(), 0.0);
  EXPECT_GT(three_quarter_view(Vec3::UnitY()).y(), 0.0);
  EXPECT_GT(three_quarter_view(-Vec3::UnitZ()).dot(-Vec3::UnitZ()), 0.0);
}

TEST(ViewOfFocus, FacesTheFocusFromEverySide) {
  const Mesh box = testing::box_mesh(2, 2, 2);
  for (const Vec3& n : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1),
                        Vec3(0, 0, -1), Vec3(1, 1, 1)}) {
    const Vec3 normal = n.normalized();
    const Vec3 toward = view_of_focus(box, Vec3::Constant(1.0) + normal, normal, Vec3::UnitZ());
    EXPECT_GT(toward.dot(normal), 0.45) << n.transpose();
    EXPECT_NEAR(toward.norm(), 1.0, 1e-12);
  }
}

TEST(ViewOfFocus, LooksRoundWhatStandsBefore) {
  // The focus is on a box at the origin; a big screen stands between it and the usual view.
  Mesh scene = testing::box_mesh(1, 1, 1);
  const Vec3 focus(0.5, 0.0, 0.5), normal(0, -1, 0);
  const Vec3 open = view_of_focus(scene, focus, normal, Vec3::UnitZ());
  Mesh screen;
  const Vec3 before = focus + 2.0 * open;
  const Camera frame = look_along(open, Vec3::UnitZ());
  screen.positions = {before - 0.4 * frame.right - 0.4 * frame.up,
                      before + 0.4 * frame.right - 0.4 * frame.up, before + 0.4 * frame.up};
  screen.triangles = {{0, 1, 2}};
  append(scene, screen);
  const Vec3 round = view_of_focus(scene, focus, normal, Vec3::UnitZ());
  EXPECT_LT(round.dot(open), 0.999);
  EXPECT_GT(round.dot(normal), 0.25);
}

TEST(ViewOfFocus, LongThingsLieDown) {
  const Mesh bar = testing::box_mesh(1, 12, 1);
  const Vec3 toward = view_of_focus(bar, Vec3(0.5, 6, 1), Vec3::UnitZ(), Vec3::UnitZ());
  const Camera camera = look_along(toward, Vec3::UnitZ());
  const Frame2d seen = covered(camera, bar.positions);
  EXPECT_GT(seen.width(), 1.8 * seen.height());
}

TEST(Camera, UnusableDirectionsAreRefused) {
  EXPECT_THROW(look_along(Vec3::Zero(), Vec3::UnitZ()), PreconditionError);
  const Camera direction = look_along(Vec3::UnitX(), Vec3::UnitZ());
  EXPECT_THROW(fit(direction, {}, 10, 10, 5.0), PreconditionError);
}

}  // namespace
}  // namespace isochor
