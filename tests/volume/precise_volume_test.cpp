#include "isochor/volume/precise_volume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "isochor/base/error.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/tau_tensor.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

Rational exact(const DoubleDouble& a) { return Rational(a.high()) + Rational(a.low()); }

PatchModel random_patch(std::mt19937& random, int du, int dv, int breaks) {
  PatchModel model;
  Patch patch{"sheet",
              "face:1",
              testing::random_clamped(random, du, breaks),
              testing::random_unclamped(random, dv, breaks + 1),
              {},
              {},
              false,
              {},
              {}};
  for (int k = 0; k < patch.u_size() * patch.v_size(); ++k) patch.points.push_back(k);
  patch.reversed = breaks % 2 == 1;
  model.points = testing::random_points(random, patch.points.size());
  model.patches = {patch};
  return model;
}

// Lifted far up, so that positions weigh more than differences.
void expect_enclosed(const PatchModel& model) {
  const Rational wanted = ExactVolume(model).value(model.points);
  const PreciseNumber precise = precise_flux(model.patches[0], model.points);
  EXPECT_LE((exact(precise.value) - wanted).abs(), Rational(precise.bound));
  EXPECT_LT(precise.bound, 1e-20 * (1.0 + std::abs(wanted.to_double())));
  const Bounded rounded = precise.rounded();
  const Rational error = (Rational(rounded.value) - wanted).abs();
  EXPECT_LE(error, Rational(rounded.bound));
  EXPECT_LE(rounded.bound, 1.1 * 0x1p-53 * std::abs(rounded.value) + 1e-20);
}

TEST(PreciseVolume, Bound) {
  std::mt19937 random(91);
  for (int du = 1; du <= 6; ++du) {
    for (int dv : {1, 3, 6}) {
      PatchModel model = random_patch(random, du, dv, du % 3);
      expect_enclosed(model);
      for (Vec3& p : model.points) p += Vec3(1e3, -1e4, 1e5);
      const Bounded far = precise_flux(model.patches[0], model.points).rounded();
      const Rational wanted = ExactVolume(model).value(model.points);
      EXPECT_LE((Rational(far.value) - wanted).abs(), Rational(far.bound));
    }
  }
}

TEST(PreciseVolume, HighDegrees) {
  std::mt19937 random(92);
  for (const auto& [du, dv] : {std::pair(13, 7), std::pair(22, 1)}) {
    expect_enclosed(random_patch(random, du, dv, 0));
  }
}

// Law (3) of the tensors, which the bound rests on.
TEST(PreciseVolume, TensorsKeepTheirAccuracy) {
  std::mt19937 random(93);
  for (int degree : {1, 2, 3, 5, 8}) {
    const KnotVector knots = testing::random_clamped(random, degree, 2);
    const BasicTauTensor<DoubleDouble> precise(knots);
    const TauTensor plain(knots);
    for (int i = 0; i < knots.size(); ++i) {
      for (int k = 0; k < knots.size(); ++k) {
        for (int j = 0; j + 1 < knots.size(); ++j) {
          const DoubleDouble entry = precise(i, k, j);
          const double error = std::abs(to_double(entry - DoubleDouble(plain(i, k, j))));
          EXPECT_LE(error, tau_error(degree) * entry.high());
          EXPECT_GE(entry.high(), 0.0);
        }
      }
    }
  }
}

TEST(PreciseVolume, RationalTensorOfOneLinearSpan) {
  const BasicTauTensor<DoubleDouble> tau(KnotVector::uniform(1, 1, 0.0, 3.0));
  EXPECT_LT((exact(tau(0, 0, 0)) - Rational(1) / Rational(3)).abs().to_double(), 1e-30);
  EXPECT_LT((exact(tau(0, 1, 0)) - Rational(1) / Rational(6)).abs().to_double(), 1e-30);
}

TEST(PreciseVolume, ChangesAreLocalAndEnclosed) {
  std::mt19937 random(94);
  for (int round = 0; round < 12; ++round) {
    const PatchModel model = random_patch(random, 1 + round % 4, 1 + (round + 2) % 4, 3);
    std::vector<Vec3> after = model.points;
    for (int moved = 0; moved <= round % 3; ++moved) {
      Vec3& p = after[static_cast<size_t>(random() % after.size())];
      p += std::pow(10.0, -round) * Vec3(0.3, -0.2, 0.5);
    }
    const ExactVolume exact_volume(model);
    const Rational wanted = exact_volume.change(model.points, after);
    const PreciseNumber change = precise_flux_change(model.patches[0], model.points, after);
    EXPECT_LE((exact(change.value) - wanted).abs(), Rational(change.bound)) << round;
    EXPECT_LT(change.bound, 1e-22);
  }
}

TEST(PreciseVolume, NothingMovedIsNoChange) {
  std::mt19937 random(95);
  const PatchModel model = random_patch(random, 2, 2, 2);
  const PreciseNumber change = precise_flux_change(model.patches[0], model.points, model.points);
  EXPECT_EQ(change.value.high(), 0.0);
  EXPECT_EQ(change.bound, 0.0);
}

TEST(PreciseVolume, AreasAreTheGradientOfClosedModels) {
  const PatchModel model = testing::random_closed_model(96);
  std::vector<std::array<DoubleDouble, 3>> rows(model.points.size());
  for (const Patch& patch : model.patches) {
    const auto areas = precise_areas(patch, model.points);
    for (size_t k = 0; k < areas.size(); ++k) {
      auto& row = rows[static_cast<size_t>(patch.points[k])];
      for (size_t axis = 0; axis < 3; ++axis) row[axis] += areas[k][axis];
    }
  }
  const auto wanted = ExactVolume(model).gradient(model.points);
  for (size_t i = 0; i < rows.size(); ++i) {
    for (size_t axis = 0; axis < 3; ++axis) {
      EXPECT_LT((exact(rows[i][axis]) - wanted[i][axis]).abs().to_double(), 1e-28) << i;
    }
  }
}

TEST(PreciseVolume, MajorantIsAtLeastTheValue) {
  std::mt19937 random(97);
  const PatchModel model = random_patch(random, 3, 2, 3);
  const double value = precise_flux(model.patches[0], model.points).value.high();
  EXPECT_GE(contraction_majorant(model.patches[0], model.points, 0.0), std::abs(value));
  EXPECT_GT(contraction_majorant(model.patches[0], model.points, 9.0),
            contraction_majorant(model.patches[0], model.points, 0.0));
}

TEST(PreciseVolume, WeightsThatDifferAreRefused) {
  const PatchModel sphere = testing::make_sphere(1.0);
  EXPECT_THROW((void)precise_flux(sphere.patches[0], sphere.points), PreconditionError);
  EXPECT_THROW((void)precise_areas(sphere.patches[0], sphere.points), PreconditionError);
  EXPECT_THROW((void)contraction_majorant(sphere.patches[0], sphere.points, 0.0),
               PreconditionError);
}

}  // namespace
}  // namespace isochor
