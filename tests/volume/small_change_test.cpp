// Changes near cancellation: tiny moves on models that are large, far away, or both.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isochor/bspline/model_refinement.h"
#include "isochor/bspline/refinement.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/volume_form.h"
#include "support/bounds.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::error_of;

std::vector<Vec3> moved_by(std::mt19937& random, const std::vector<Vec3>& points,
                           const std::vector<int>& ids, double size) {
  std::vector<Vec3> moved = points;
  for (int id : ids) {
    moved[static_cast<size_t>(id)] += size * testing::random_points(random, 1)[0];
  }
  return moved;
}

TEST(SmallChange, TinyMovesOfALargeModelAMillionAway) {
  std::mt19937 random(431);
  PatchModel model = testing::random_closed_model(432);
  testing::transform(model, Eigen::Vector3d(1000, 1000, 1000).asDiagonal());
  for (const Vec3& offset : {Vec3(0, 0, 0), Vec3(1e6, -2e6, 3e6), Vec3(-1e6, 0, 0)}) {
    PatchModel far = model;
    testing::translate(far, offset);
    const VolumeForm form(far);
    const ExactVolume exact(far);
    const std::vector<int> ids = {1, 4, 9, 20};
    const Support support = form.support_of(ids);
    for (double size : {1.0, 1e-3, 1e-6, 1e-9}) {
      const auto moved = moved_by(random, far.points, ids, size);
      const Rational change = exact.change(far.points, moved);
      const Bounded computed = form.bounded_change(far.points, moved, support);
      EXPECT_LE(error_of(computed, change), computed.bound) << size;
      // The change of a face of area 1e6 by `size`, with eleven digits or more.
      EXPECT_LE(computed.bound, 1e-11 * 1e6 * size) << size;
      EXPECT_EQ(computed.value != 0.0, !change.is_zero());
    }
  }
}

// Moves that cancel: up on one side, down on the other, so that the volume changes by far less than
// any of its parts. The bound is relative to the parts, and holds.
TEST(SmallChange, OpposedMovesOfEqualVolume) {
  const PatchModel cube = testing::make_cube_model(3, 6);
  for (double lift : {1e6, 0.0}) {
    PatchModel model = cube;
    testing::translate(model, Vec3(0, 0, lift));
    const VolumeForm form(model);
    const Patch& top = model.patches[0];
    const std::vector<int> ids = {top.point(3, 3), top.point(5, 5)};
    auto moved = model.points;
    moved[static_cast<size_t>(ids[0])].z() += 0x1p-20;
    moved[static_cast<size_t>(ids[1])].z() -= 0x1p-20;
    const Rational change = ExactVolume(model).change(model.points, moved);
    const Bounded computed = form.bounded_change(model.points, moved, form.support_of(ids));
    EXPECT_LE(error_of(computed, change), computed.bound);
    EXPECT_LT(std::abs(computed.value), 1e-20);
    EXPECT_LT(computed.bound, 1e-17);
  }
}

TEST(SmallChange, NoMoveIsNoChange) {
  const PatchModel model = testing::random_closed_model(433);
  const VolumeForm form(model);
  const Bounded none = form.bounded_change(model.points, model.points, form.whole());
  EXPECT_EQ(none.value, 0.0);
  EXPECT_EQ(none.bound, 0.0);
  EXPECT_EQ(form.change(model.points, model.points, form.support_of({})), 0.0);
  EXPECT_TRUE(ExactVolume(model).change(model.points, model.points).is_zero());
}

// The form looks at the points only once, for its height: it must hold wherever they go later.
TEST(SmallChange, TheHeightOfTheFirstPointsIsOnlyAChoice) {
  const PatchModel closed = testing::random_closed_model(434);
  PatchModel open = closed;
  open.patches.pop_back();
  for (const PatchModel& model : {closed, open}) {
    for (double built_at : {0.0, 1e3}) {
      PatchModel at_build = model;
      testing::translate(at_build, Vec3(0, 0, built_at));
      const VolumeForm form(at_build);
      for (double used_at : {-500.0, 0.0, 1e3}) {
        auto points = model.points;
        for (Vec3& p : points) p.z() += used_at;
        const Bounded computed = form.bounded_value(points);
        EXPECT_LE(error_of(computed, ExactVolume(model).value(points)), computed.bound)
            << built_at << ' ' << used_at;
        EXPECT_LT(computed.bound, 1e-8);
        auto moved = points;
        moved[0] += Vec3(1e-3, 2e-3, -1e-3);
        const Bounded change = form.bounded_change(points, moved, form.support_of({0}));
        EXPECT_LE(error_of(change, ExactVolume(model).change(points, moved)), change.bound);
      }
    }
  }
}

// A flat sheet far from zero: all of its volume is in the rim's term.
TEST(SmallChange, AFlatSheetHasItsHeightTimesItsArea) {
  PatchModel sheet = testing::random_open_patch(435, 2, 3, 2);
  for (Vec3& p : sheet.points) p.z() = 1024.0;
  const VolumeForm form(sheet);
  const Bounded computed = form.bounded_value(sheet.points);
  const Rational exact = ExactVolume(sheet).value(sheet.points);
  EXPECT_LE(error_of(computed, exact), computed.bound);
  EXPECT_NEAR(computed.value, exact.to_double(), 1e-12);
  EXPECT_GT(std::abs(computed.value), 1.0);
}

TEST(SmallChange, ChangesAddUpAlongAPath) {
  std::mt19937 random(436);
  testing::RandomModelOptions options;
  options.weight_ratio = 2.0;
  const PatchModel model = testing::random_closed_model(437, options);
  const VolumeForm form(model);
  const std::vector<int> ids = {0, 3, 8, 13};
  const Support support = form.support_of(ids);
  std::vector<Vec3> at = model.points;
  double sum = 0.0;
  for (int step = 0; step < 20; ++step) {
    const auto next = moved_by(random, at, ids, 0.01);
    sum += form.change(at, next, support);
    // There and back is nothing, but for rounding.
    EXPECT_NEAR(form.change(at, next, support), -form.change(next, at, support), 1e-17);
    at = next;
  }
  EXPECT_NEAR(sum, form.change(model.points, at, support), 1e-16);
}

TEST(SmallChange, SupportsHoldEveryElementThatFeelsAPoint) {
  // Second method: an element feels a point when the exact change there is not zero.
  testing::RandomModelOptions options;
  options.degrees[0] = 1;
  options.degrees[1] = 3;
  const PatchModel model = testing::random_closed_model(438, options);
  const VolumeForm form(model);
  const Support whole = form.whole();
  for (int id = 0; id < form.point_count(); id += 3) {
    const Support support = form.support_of({id});
    size_t found = 0;
    auto moved = model.points;
    moved[static_cast<size_t>(id)] += Vec3(0.5, -0.25, 0.75);
    for (const Element& element : whole.elements) {
      Support alone = whole;
      alone.elements = {element};
      const bool feels = form.value(moved, alone) != form.value(model.points, alone);
      const bool listed = found < support.elements.size() && support.elements[found] == element;
      found += listed;
      EXPECT_EQ(feels, listed) << id;
    }
    EXPECT_EQ(found, support.elements.size());
    EXPECT_EQ(support.row_of[static_cast<size_t>(id)], 0);
  }
}

}  // namespace
}  // namespace isochor
