// Gauss against exact rationals: within the stated bound, and the bound is not idle.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isochor/base/tolerance.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/volume_form.h"
#include "support/bounds.h"
#include "support/models.h"
#include "support/worst.h"

namespace isochor {
namespace {

using testing::error_of;
using testing::random_closed_model;
using testing::random_open_patch;
using testing::RandomModelOptions;
using testing::Worst;

// Degrees 1 to 6 mixed, clamped with multiplicities and unclamped, closed and open.
std::vector<PatchModel> polynomial_models() {
  std::vector<PatchModel> models;
  std::uint32_t seed = 100;
  for (int degree = 1; degree <= 6; ++degree) {
    RandomModelOptions options;
    options.degrees[0] = degree;
    options.degrees[1] = 1 + degree % 4;
    options.degrees[2] = 7 - degree;
    options.spans = 2;
    models.push_back(random_closed_model(seed++, options));
    models.push_back(random_open_patch(seed++, degree, 7 - degree, 3, false));
    models.push_back(random_open_patch(seed++, degree, 1 + degree / 2, 3, true));
    models.back().patches[0].reversed = true;
  }
  return models;
}

TEST(VolumeBound, ValueHoldsAgainstExactRationals) {
  Worst part("error_over_proven_bound", 1.0);
  Worst bound("proven_bound", 1e-10);
  for (const PatchModel& model : polynomial_models()) {
    const Bounded computed = VolumeForm(model).bounded_value(model.points);
    EXPECT_NEAR(computed.value, VolumeForm(model).value(model.points), 1e-14);
    const Bounded gauss = VolumeForm(model).quadrature_value(model.points);
    EXPECT_LE(error_of(gauss, ExactVolume(model).value(model.points)), gauss.bound);
    ASSERT_GT(computed.bound, 0.0);
    const double error = error_of(computed, ExactVolume(model).value(model.points));
    EXPECT_TRUE(part.see(error / computed.bound)) << error;
    EXPECT_TRUE(bound.see(computed.bound));
  }
}

TEST(VolumeBound, GradientsHoldAgainstExactRationals) {
  // Rows are sums of terms of the size (model)^2; the law of quadrature is eps times the number of
  // points along a side, measured at less than a quarter of this.
  Worst worst("gradient", 16 * kUnitRoundoff);
  for (const PatchModel& model : polynomial_models()) {
    const auto computed = VolumeForm(model).gradient(model.points);
    const auto exact = ExactVolume(model).gradient(model.points);
    for (size_t i = 0; i < exact.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        const Rational error = Rational(computed[i][axis]) - exact[i][static_cast<size_t>(axis)];
        EXPECT_TRUE(worst.see(error.abs().to_double())) << i << ' ' << axis;
      }
    }
  }
}

TEST(VolumeBound, ChangeIsAccurateHoweverSmall) {
  std::mt19937 random(120);
  std::normal_distribution<double> normal;
  for (const PatchModel& model : polynomial_models()) {
    const VolumeForm form(model);
    const ExactVolume exact(model);
    const Support support = form.support_of({0, 2, 5, 9});
    for (double size : {1e-1, 1e-6, 1e-12}) {
      auto moved = model.points;
      for (int id : support.points) {
        for (int axis = 0; axis < 3; ++axis) {
          moved[static_cast<size_t>(id)][axis] += size * (1.0 + 0.1 * normal(random));
        }
      }
      const Rational change = exact.change(model.points, moved);
      const Bounded computed = form.bounded_change(model.points, moved, support);
      EXPECT_LE(error_of(computed, change), computed.bound);
      EXPECT_LE(computed.bound, 1e-10 * size);
      EXPECT_NEAR(computed.value / change.to_double(), 1.0, 1e-10) << size;
      EXPECT_NEAR(form.change(model.points, moved, support), computed.value, 1e-14 * size);
    }
  }
}

TEST(VolumeBound, ChangeOfATrillionthOfTheVolume) {
  // The largest lift that changes the unit cube by about 1e-12 of its volume.
  const PatchModel cube = testing::make_cube_model(3, 12);
  const int middle = cube.patches[0].point(7, 7);
  auto moved = cube.points;
  moved[static_cast<size_t>(middle)].z() += 144e-12;
  const VolumeForm form(cube);
  const double change = form.change(cube.points, moved, form.support_of({middle}));
  const double exact = ExactVolume(cube).change(cube.points, moved).to_double();
  EXPECT_NEAR(exact, 1e-12, 1e-15);
  EXPECT_NEAR(change / exact, 1.0, 1e-13);
}

TEST(VolumeBound, HighDegrees) {
  for (int degree : {9, 13}) {
    const PatchModel model = random_open_patch(130, degree, 3, 1);
    const Bounded computed = VolumeForm(model).bounded_value(model.points);
    EXPECT_LE(error_of(computed, ExactVolume(model).value(model.points)), computed.bound);
  }
  const PatchModel model = random_open_patch(131, kMaxDegree, 1, 1);
  const Bounded computed = VolumeForm(model).bounded_value(model.points);
  EXPECT_LE(error_of(computed, ExactVolume(model).value(model.points)), computed.bound);
}

TEST(VolumeBound, KnotsFarFromZeroLoseNothing) {
  PatchModel model = random_open_patch(132, 3, 3, 4);
  std::vector<double> knots = model.patches[0].u_knots.knots();
  for (double& t : knots) t += 1e6;
  model.patches[0].u_knots = KnotVector(3, knots);
  const Bounded computed = VolumeForm(model).bounded_value(model.points);
  const Rational exact = ExactVolume(model).value(model.points);
  EXPECT_LE(error_of(computed, exact), computed.bound);
  EXPECT_LT(error_of(computed, exact), 1e-15);
}

TEST(VolumeBound, ClosedModelsFarFromTheOriginLoseNothing) {
  for (double far : {1e2, 1e4, 1e6}) {
    PatchModel cube = testing::make_cube_model(3, 12);
    testing::translate(cube, Vec3(far, -far / 3, 1.1 * far));
    const VolumeForm form(cube);
    const Bounded computed = form.bounded_value(cube.points);
    const Rational exact = ExactVolume(cube).value(cube.points);
    EXPECT_LE(error_of(computed, exact), computed.bound);
    EXPECT_LT(error_of(computed, exact), 1e-15) << far;
    EXPECT_LT(computed.bound, 1e-12);
  }
}

TEST(VolumeBound, ShiftsThatAreExactChangeNoBit) {
  PatchModel model = random_closed_model(133);
  for (Vec3& p : model.points) p = (p * 1024.0).array().round() / 1024.0;
  testing::translate(model, Vec3(8.0, 8.0, 8.0));
  const VolumeForm near(model);
  const double value = near.value(model.points);
  const auto gradient = near.gradient(model.points);
  testing::translate(model, Vec3(0x1p20, -0x1p18, 0x1p21));
  const VolumeForm far(model);
  EXPECT_EQ(far.value(model.points), value);
  EXPECT_EQ(far.gradient(model.points), gradient);
}

TEST(VolumeBound, OpenModelsFarFromTheOriginKeepTheirMeaning) {
  std::vector<PatchModel> models = {random_open_patch(134, 3, 2, 3),
                                    random_open_patch(135, 2, 4, 3, true),
                                    random_closed_model(136)};
  models.back().patches.pop_back();  // a box without its front
  for (PatchModel& model : models) {
    testing::translate(model, Vec3(100.0, 30.0, 1e4));
    const VolumeForm form(model);
    const ExactVolume exact(model);
    const Rational value = exact.value(model.points);
    const Bounded computed = form.bounded_value(model.points);
    EXPECT_NEAR(computed.value, form.value(model.points), 1e-11);
    const Bounded gauss = form.quadrature_value(model.points);
    EXPECT_LE(error_of(gauss, value), gauss.bound);
    EXPECT_LE(error_of(computed, value), computed.bound);
    EXPECT_LT(computed.bound, 1e-11 * 1e4);
    const auto rows = form.gradient(model.points);
    const auto exact_rows = exact.gradient(model.points);
    for (size_t i = 0; i < rows.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(rows[i][axis], exact_rows[i][static_cast<size_t>(axis)].to_double(), 1e-11);
      }
    }
    const Support support = form.support_of({0, 1, 4});
    auto moved = model.points;
    for (int id : support.points) moved[static_cast<size_t>(id)] += Vec3(0.25, -0.5, 0.125);
    const Bounded change = form.bounded_change(model.points, moved, support);
    EXPECT_LE(error_of(change, exact.change(model.points, moved)), change.bound);
    EXPECT_NEAR(form.value(moved, support) - form.value(model.points, support), change.value,
                1e-10);
  }
}

}  // namespace
}  // namespace isochor
