#include "isochor/volume/exact_volume.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "isochor/base/error.h"
#include "isochor/volume/volume_form.h"
#include "support/models.h"

namespace isochor {
namespace {

using testing::make_box_model;
using testing::make_cube_model;
using testing::random_closed_model;
using testing::RandomModelOptions;

TEST(ExactVolume, BoxWithDyadicPointsIsExactlyItsProduct) {
  // Two spans of degree 2 have Greville points 0, 1/4, 3/4, 1: dyadic, so nothing was rounded.
  PatchModel box = make_cube_model(2, 2);
  testing::transform(box, Eigen::Vector3d(3.0, 0.5, 1.25).asDiagonal());
  EXPECT_EQ(ExactVolume(box).value(box.points), Rational::parse("1.875"));
}

TEST(ExactVolume, PyramidByHand) {
  // One bilinear patch over the unit square with corner heights 0, 0, 0, 1: z = u v, V = 1/4.
  PatchModel sheet = testing::random_open_patch(1, 1, 1, 1);
  sheet.points = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 1}};
  EXPECT_EQ(ExactVolume(sheet).value(sheet.points), Rational(0.25));
  sheet.patches[0].reversed = true;
  EXPECT_EQ(ExactVolume(sheet).value(sheet.points), Rational(-0.25));
}

TEST(ExactVolume, SixBicubicPatches) {
  const PatchModel cube = make_cube_model(3, 12);
  const ExactVolume exact(cube);
  EXPECT_NEAR(exact.value(cube.points).to_double(), 1.0, 1e-15);
  const auto gradient = exact.gradient(cube.points);
  EXPECT_EQ(gradient.size(), cube.points.size());
}

TEST(ExactVolume, GradientIsTheExactSlopeInEachCoordinate) {
  RandomModelOptions options;
  options.degrees[0] = 1;
  options.degrees[1] = 2;
  options.spans = 2;
  const PatchModel model = random_closed_model(41, options);
  const ExactVolume exact(model);
  const Rational value = exact.value(model.points);
  const auto gradient = exact.gradient(model.points);
  for (size_t i = 0; i < model.points.size(); i += 5) {
    for (int axis = 0; axis < 3; ++axis) {
      auto moved = model.points;
      moved[i][axis] += 0.5;
      const Rational step = Rational(moved[i][axis]) - Rational(model.points[i][axis]);
      const Rational difference = exact.value(moved) - value;
      EXPECT_EQ(difference, step * gradient[i][static_cast<size_t>(axis)]);
      EXPECT_EQ(exact.change(model.points, moved), difference);
    }
  }
}

TEST(ExactVolume, ClosedModelsDoNotFeelTranslations) {
  PatchModel model = random_closed_model(42);
  for (Vec3& p : model.points) p = (p * 1024.0).array().round() / 1024.0;  // shifts are exact
  const ExactVolume exact(model);
  const Rational value = exact.value(model.points);
  const auto gradient = exact.gradient(model.points);
  testing::translate(model, Vec3(1024.0, -3.0, 4096.0));
  EXPECT_EQ(exact.value(model.points), value);
  EXPECT_EQ(exact.gradient(model.points), gradient);
}

TEST(ExactVolume, EulerRelation) {
  // V is homogeneous of degree one in each column: each column's <gradient, coordinate> is V.
  const PatchModel model = testing::random_open_patch(43, 2, 4, 2, true);
  const ExactVolume exact(model);
  const auto gradient = exact.gradient(model.points);
  const Rational value = exact.value(model.points);
  for (size_t axis = 0; axis < 3; ++axis) {
    Rational sum;
    for (size_t i = 0; i < model.points.size(); ++i) {
      sum += gradient[i][axis] * Rational(model.points[i][static_cast<int>(axis)]);
    }
    EXPECT_EQ(sum, value);
  }
}

TEST(ExactVolume, WeightsAreRefusedByNameUnlessEqualOrUntouched) {
  PatchModel model = random_closed_model(44);
  const Rational value = ExactVolume(model).value(model.points);
  Patch& patch = model.patches[3];
  patch.weights.assign(patch.points.size(), 2.5);
  EXPECT_EQ(ExactVolume(model).value(model.points), value);
  patch.weights[4] = 1.0;
  const ExactVolume mixed(model);
  EXPECT_FALSE(mixed.polynomial());
  try {
    static_cast<void>(mixed.value(model.points));
    FAIL() << "weights were accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("patch face:4: has weights"));
  }
  // A point inside another patch can be followed exactly; one of this patch cannot.
  auto moved = model.points;
  const Patch& top = model.patches[0];
  moved[static_cast<size_t>(top.point(top.u_size() / 2, top.v_size() / 2))].z() += 0.125;
  EXPECT_EQ(mixed.change(model.points, moved).sign(), 1);
  moved[static_cast<size_t>(patch.point(1, 1))].z() += 0.125;
  EXPECT_THROW(static_cast<void>(mixed.change(model.points, moved)), InputError);
}

TEST(ExactVolume, ExtremeMagnitudesStayExact) {
  PatchModel model = make_cube_model(1, 1);
  const double big = 0x1p300;
  const double small = 0x1p-300;
  testing::transform(model, Eigen::Vector3d(big, small, small).asDiagonal());
  EXPECT_EQ(ExactVolume(model).value(model.points), Rational(small));
}

}  // namespace
}  // namespace isochor
