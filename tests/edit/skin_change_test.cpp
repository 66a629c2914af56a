#include "isochor/edit/skin_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "isochor/base/error.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"

namespace isochor {
namespace {

constexpr int kPolesPerSide = 4;

// Two flat bicubic Bezier patches side by side along x, smooth across x = 1.
PatchModel make_two_flat_patches() {
  PatchModel model;
  const KnotVector knots(3, {0, 0, 0, 0, 1, 1, 1, 1});
  for (int i = 0; i < 2 * kPolesPerSide - 1; ++i) {
    for (int j = 0; j < kPolesPerSide; ++j) model.points.emplace_back(i / 3.0, j / 3.0, 0.0);
  }
  for (int q = 0; q < 2; ++q) {
    std::vector<int> points(kPolesPerSide * kPolesPerSide);
    std::iota(points.begin(), points.end(), q * kPolesPerSide * (kPolesPerSide - 1));
    model.patches.push_back(
        {"", "face:" + std::to_string(q + 1), knots, knots, std::move(points), {}, false, {}, {}});
  }
  model.joins = find_joins(model);
  derive_locks(model);
  return model;
}

// The second patch turned about the join.
std::vector<Vec3> folded(const PatchModel& model, double angle_rad) {
  std::vector<Vec3> points = model.points;
  for (Vec3& p : points) {
    if (p.x() > 1.0) p.z() = std::tan(angle_rad) * (p.x() - 1.0);
  }
  return points;
}

TEST(SkinGauge, NothingMovedIsNoChange) {
  const PatchModel model = make_two_flat_patches();
  const SkinMeasures measures = SkinGauge(model).measure(model.points, {false, false});
  EXPECT_EQ(measures.joins.count, 1);
  EXPECT_EQ(measures.change.joins, 0);
  EXPECT_EQ(measures.change.angle_rad, 0.0);
}

TEST(SkinGauge, AFoldIsMeasuredAsItsAngle) {
  const PatchModel model = make_two_flat_patches();
  SkinGauge gauge(model);
  for (double angle : {1e-9, 0.01, 0.7}) {
    const SkinMeasures measures = gauge.measure(folded(model, angle), {false, true});
    EXPECT_EQ(measures.change.joins, 1);
    EXPECT_NEAR(measures.change.angle_rad, angle, 1e-15 + 1e-12 * angle);
    EXPECT_EQ(measures.joins.angle_change_rad, measures.change.angle_rad);
    EXPECT_EQ(measures.joins.max_angle_rad, measures.change.angle_rad);
  }
}

// An edit that keeps positions only leaves measures of joins behind that are no longer true.
TEST(SkinGauge, TheRestShapeIsMeasuredNotBelieved) {
  PatchModel model = make_two_flat_patches();
  model.points = folded(model, 0.3);
  ASSERT_LT(model.joins.front().max_angle_rad, 1e-12);
  SkinGauge gauge(model);
  EXPECT_NEAR(gauge.measure(model.points, {false, false}).joins.max_angle_rad, 0.3, 1e-12);
  std::vector<Vec3> shifted = model.points;
  for (Vec3& p : shifted) p += Vec3(0.5, 0.25, 0.125);
  EXPECT_NEAR(gauge.measure(shifted, {true, true}).change.angle_rad, 0.0, 1e-14);
}

TEST(SkinGauge, MovedIsOneFlagPerPatch) {
  const PatchModel model = make_two_flat_patches();
  SkinGauge gauge(model);
  EXPECT_THROW((void)gauge.measure(model.points, {true}), PreconditionError);
}

}  // namespace
}  // namespace isochor
