// Value, gradient and change against exact rationals on many small models of every kind, and what
// must hold to the last bit or over the rationals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/bspline/model_refinement.h"
#include "isochor/bspline/refinement.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/theta.h"
#include "isochor/volume/volume_form.h"
#include "support/bounds.h"
#include "support/messages.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::error_of;
using ::isochor::testing::message_of;
using ::isochor::testing::random_open_patch;
using ::testing::HasSubstr;

PatchModel single_patch(const Surface& surface) { return testing::make_separate_model({surface}); }

// The bound is not violated once, though it is hardly more than the rounding of the result.
TEST(VolumeExactness, BoundHoldsOnManySmallPatches) {
  std::mt19937 random(411);
  int patches = 0;
  double closest = 0.0;
  for (int round = 0; round < 400; ++round) {
    const int du = 1 + round % 3;
    const int dv = 1 + (round / 3) % 3;
    const KnotVector u = round % 2 == 0 ? testing::random_clamped(random, du, 1)
                                        : testing::random_unclamped(random, du, 1);
    const Surface surface =
        testing::random_surface(random, u, testing::random_clamped(random, dv, 1), false);
    PatchModel model = single_patch(surface);
    model.patches[0].reversed = round % 5 == 0;
    if (round % 4 == 1) testing::translate(model, Vec3(300, -20, 40));
    const Bounded computed = VolumeForm(model).bounded_value(model.points);
    const double error = error_of(computed, ExactVolume(model).value(model.points));
    EXPECT_LE(error, computed.bound) << round;
    closest = std::max(closest, error / computed.bound);
    ++patches;
  }
  EXPECT_EQ(patches, 400);
  EXPECT_GT(closest, 0.5);  // a bound that is far off would be of little use
}

TEST(VolumeExactness, HighDegreesValueAndGradient) {
  for (const auto& [du, dv] : {std::pair{13, 7}, std::pair{22, 1}, std::pair{1, 22}}) {
    const PatchModel model = random_open_patch(412, du, dv, 1);
    const VolumeForm form(model);
    const ExactVolume exact(model);
    const Bounded computed = form.bounded_value(model.points);
    EXPECT_LE(error_of(computed, exact.value(model.points)), computed.bound) << du << ' ' << dv;
    EXPECT_LT(computed.bound, 1e-11);
    if (du == 13) continue;  // the exact gradient takes ten times as long
    const auto rows = form.gradient(model.points);
    const auto exact_rows = exact.gradient(model.points);
    for (size_t i = 0; i < rows.size(); ++i) {
      for (size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(rows[i][static_cast<int>(axis)], exact_rows[i][axis].to_double(),
                    16 * kUnitRoundoff);
      }
    }
  }
}

// Halving Bezier patches at 1/2 is dyadic, so nothing is rounded and the rational volume must be
// the same number; the parts of a cut patch add up to it.
TEST(VolumeExactness, AdditiveUnderRefinementAndSplittingOverTheRationals) {
  std::mt19937 random(413);
  for (const auto& [du, dv] :
       {std::pair{1, 1}, std::pair{2, 3}, std::pair{4, 1}, std::pair{3, 3}}) {
    const KnotVector u = KnotVector::uniform(du, 1);
    const KnotVector v = KnotVector::uniform(dv, 1);
    std::vector<Vec3> poles =
        testing::random_points(random, static_cast<size_t>((du + 1) * (dv + 1)));
    for (Vec3& p : poles) p = (p * 1024.0).array().round() / 1024.0;
    const Surface whole(u, v, poles);
    const PatchModel model = single_patch(whole);
    const Rational volume = ExactVolume(model).value(model.points);
    const Surface halved =
        refine(whole, with_knots(u, std::vector<double>(static_cast<size_t>(du), 0.5)), v);
    const PatchModel refined = single_patch(halved);
    EXPECT_EQ(ExactVolume(refined).value(refined.points), volume);
    std::vector<Surface> halves;
    for (int half : {0, 1}) {
      std::vector<Vec3> part(halved.poles().begin() + half * du * (dv + 1),
                             halved.poles().begin() + (half * du + du + 1) * (dv + 1));
      halves.emplace_back(u, v, part);
    }
    const PatchModel split = testing::make_separate_model(halves);
    EXPECT_EQ(ExactVolume(split).value(split.points), volume);
    const VolumeForm form(split);
    EXPECT_NEAR(form.value(split.points), volume.to_double(), 1e-15);
  }
}

TEST(VolumeExactness, RefinedModelsKeepTheirVolume) {
  testing::RandomModelOptions options;
  options.degrees[0] = 2;
  options.degrees[1] = 4;
  for (double ratio : {1.0, 3.0}) {
    options.weight_ratio = ratio;
    const PatchModel model = testing::random_closed_model(414, options);
    const Patch& patch = model.patches[4];
    const PatchModel fine =
        refine(model, 4, refined_to_spans(patch.u_knots, 6), refined_to_spans(patch.v_knots, 8));
    const Bounded a = VolumeForm(model).bounded_value(model.points);
    const Bounded b = VolumeForm(fine).bounded_value(fine.points);
    // The bounds are about the poles as they are; refinement rounds the new ones.
    EXPECT_NEAR(a.value, b.value, a.bound + b.bound + 2e-15);
  }
}

// Quarter turns about z and mirrors permute the terms of every sum without rounding.
TEST(VolumeExactness, QuarterTurnsAboutZChangeNoBit) {
  const PatchModel model = testing::random_closed_model(415);
  Eigen::Matrix3d turn;
  turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const VolumeForm form(model);
  const double value = form.value(model.points);
  PatchModel turned = model;
  for (int quarter = 1; quarter < 4; ++quarter) {
    testing::transform(turned, turn);
    EXPECT_EQ(form.value(turned.points), value) << quarter;
  }
  for (int axis = 0; axis < 3; ++axis) {
    auto mirrored = model.points;
    for (Vec3& p : mirrored) p[axis] = -p[axis];
    EXPECT_EQ(form.value(mirrored), -value) << axis;
    EXPECT_EQ(ExactVolume(model).value(mirrored), -ExactVolume(model).value(model.points));
  }
}

TEST(VolumeExactness, TurningTheAxesIsExactOverTheRationals) {
  // On closed models only: x dy dz, y dz dx and z dx dy are three different fluxes.
  const PatchModel model = testing::random_closed_model(416);
  const ExactVolume exact(model);
  const Rational value = exact.value(model.points);
  std::vector<Vec3> turned;
  for (const Vec3& p : model.points) turned.emplace_back(p.y(), p.z(), p.x());
  EXPECT_EQ(exact.value(turned), value);
  EXPECT_NEAR(VolumeForm(model).value(turned), value.to_double(), 1e-14);
  // Any rotation, in double.
  const Eigen::AngleAxisd any(0.7, Vec3(1, -2, 0.5).normalized());
  PatchModel rotated = model;
  testing::transform(rotated, any.toRotationMatrix());
  EXPECT_NEAR(VolumeForm(rotated).value(rotated.points), value.to_double(), 1e-14);
  const PatchModel sheet = random_open_patch(417, 2, 2, 2);
  std::vector<Vec3> other;
  for (const Vec3& p : sheet.points) other.emplace_back(p.y(), p.z(), p.x());
  EXPECT_NE(ExactVolume(sheet).value(other), ExactVolume(sheet).value(sheet.points));
}

TEST(VolumeExactness, ReversalIsTheSignOfEverything) {
  PatchModel model = random_open_patch(418, 3, 2, 2, true);
  PatchModel turned = model;
  turned.patches[0].reversed = true;
  testing::translate(model, Vec3(0, 0, 50));  // with a rim, too
  testing::translate(turned, Vec3(0, 0, 50));
  const VolumeForm a(model);
  const VolumeForm b(turned);
  EXPECT_EQ(b.value(model.points), -a.value(model.points));
  EXPECT_EQ(b.bounded_value(model.points).bound, a.bounded_value(model.points).bound);
  const auto rows = a.gradient(model.points);
  const auto opposite = b.gradient(model.points);
  for (size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(opposite[i], -rows[i]);
  EXPECT_EQ(ExactVolume(turned).value(model.points), -ExactVolume(model).value(model.points));
}

// The exact change is the exact cubic: linear part by the gradient, no remainder for one axis.
TEST(VolumeExactness, ExactChangesAreCubicsWithTheGradientInFront) {
  const PatchModel model = random_open_patch(419, 2, 2, 2);
  const ExactVolume exact(model);
  const Rational at_rest = exact.value(model.points);
  std::mt19937 random(420);
  auto moves = testing::random_points(random, model.points.size());
  for (Vec3& m : moves) m = (m * 256.0).array().round() / 256.0;
  const auto change = [&](double s) {
    auto moved = model.points;
    for (size_t i = 0; i < moved.size(); ++i) {
      // Points on a coarse grid, so that p + s m is exact.
      moved[i] = (model.points[i] * 0x1p20).array().round() / 0x1p20 + s * moves[i].array();
    }
    return exact.value(moved);
  };
  const Rational zero = change(0.0);
  const Rational one = change(1.0) - zero;
  const Rational minus = change(-1.0) - zero;
  const Rational two = change(2.0) - zero;
  // Interpolate c1 s + c2 s^2 + c3 s^3 and predict two more values.
  const Rational c2 = (one + minus) / Rational(2);
  const Rational c3 = (two - Rational(2) * one - Rational(2) * c2) / Rational(6);
  const Rational c1 = one - c2 - c3;
  for (int s : {-3, 4}) {
    const Rational t(s);
    EXPECT_EQ(change(s) - zero, ((c3 * t + c2) * t + c1) * t);
  }
  EXPECT_NE(c3, Rational(0));
  EXPECT_NE(at_rest, Rational(0));
}

TEST(VolumeExactness, TablesAndPatchesThatDoNotFitAreTheCallersBug) {
  const PatchModel model = testing::make_cube_model(1, 1);
  const auto broken = [&](auto&& change) {
    PatchModel copy = model;
    change(copy);
    std::string all = message_of<PreconditionError>([&] { VolumeForm{copy}; });
    EXPECT_EQ(message_of<PreconditionError>([&] { ExactVolume{copy}; }), all);
    EXPECT_EQ(
        message_of<PreconditionError>([&] { static_cast<void>(theta_volume(copy, copy.points)); }),
        all);
    return all;
  };
  EXPECT_EQ(broken([](PatchModel&) {}), "no error");
  EXPECT_THAT(broken([](PatchModel& m) { m.patches[2].points.pop_back(); }),
              HasSubstr("face:3 3 4"));
  EXPECT_THAT(broken([](PatchModel& m) { m.patches[2].points[1] = 8; }), HasSubstr("face:3 8 8"));
  EXPECT_THAT(broken([](PatchModel& m) { m.patches[5].points[0] = -1; }), HasSubstr("face:6 -1"));
  EXPECT_THAT(broken([](PatchModel& m) {
                m.patches[0].weights = {1, 1, 1};
              }),
              HasSubstr("face:1 3 4"));
  const std::vector<Vec3> short_table(3, Vec3::Zero());
  const ExactVolume exact(model);
  EXPECT_THROW(static_cast<void>(exact.value(short_table)), PreconditionError);
  EXPECT_THROW(static_cast<void>(exact.gradient(short_table)), PreconditionError);
  EXPECT_THROW(static_cast<void>(exact.change(model.points, short_table)), PreconditionError);
  EXPECT_THROW(static_cast<void>(theta_gradient(model, short_table)), PreconditionError);
  EXPECT_THROW(static_cast<void>(VolumeForm(model).gauss_points(6)), PreconditionError);
  EXPECT_THROW(static_cast<void>(VolumeForm(model).gauss_points(-1)), PreconditionError);
}

// What is not a number has no rational value: it must not come back as one.
TEST(VolumeExactness, NotANumberIsRefusedExactly) {
  PatchModel model = testing::make_cube_model(1, 1);
  const ExactVolume exact(model);
  for (double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    auto points = model.points;
    points[5].x() = bad;
    EXPECT_THAT(message_of<PreconditionError>([&] { static_cast<void>(exact.value(points)); }),
                HasSubstr("isfinite"));
    EXPECT_THROW(static_cast<void>(exact.gradient(points)), PreconditionError);
    EXPECT_THROW(static_cast<void>(exact.change(model.points, points)), PreconditionError);
  }
  // The smallest and the largest numbers are numbers.
  auto points = model.points;
  for (Vec3& p : points) p *= 5e-324;
  EXPECT_EQ(exact.value(points), Rational(5e-324) * Rational(5e-324) * Rational(5e-324));
}

}  // namespace
}  // namespace isochor
