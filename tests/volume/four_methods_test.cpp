// The volume of polynomial patches in four ways: as published (theta tensors), fast (tensors on
// differences), by Gauss quadrature, and in rationals, which settles who is right.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "isochor/volume/contraction.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/theta.h"
#include "isochor/volume/volume_form.h"
#include "support/bounds.h"
#include "support/splines.h"
#include "support/worst.h"

namespace isochor {
namespace {

using testing::error_of;

struct Shape {
  int u_degree, v_degree;
  int u_breaks, v_breaks;  // interior ones, before multiplicity
};

PatchModel random_patch(std::mt19937& random, const Shape& shape) {
  const auto knots = [&](int degree, int breaks) {
    return random() % 3 == 0 ? testing::random_unclamped(random, degree, breaks + 1)
                             : testing::random_clamped(random, degree, breaks);
  };
  PatchModel model;
  Patch patch{"sheet",
              "face:1",
              knots(shape.u_degree, shape.u_breaks),
              knots(shape.v_degree, shape.v_breaks),
              {},
              {},
              random() % 2 == 0,
              {},
              {}};
  for (int k = 0; k < patch.u_size() * patch.v_size(); ++k) patch.points.push_back(k);
  model.points = testing::random_points(random, patch.points.size());
  model.patches = {patch};
  return model;
}

// How far each bound is from the error it bounds; errors of zero count as unbounded.
struct Pessimism {
  std::vector<double> published, fast, gauss, printed;

  static void see(const Bounded& computed, const Rational& exact, std::vector<double>& into) {
    const double error = error_of(computed, exact);
    ASSERT_LE(error, computed.bound);
    into.push_back(error > 0.0 ? computed.bound / error : HUGE_VAL);
  }
  static double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
  }
};

void compare(const PatchModel& model, bool with_published, Pessimism& pessimism) {
  const Rational exact = ExactVolume(model).value(model.points);
  const VolumeForm form(model);
  Pessimism::see(form.bounded_value(model.points), exact, pessimism.printed);
  Pessimism::see(form.quadrature_value(model.points), exact, pessimism.gauss);
  for (InstructionSet set : {InstructionSet::kPortable, best_instruction_set()}) {
    Pessimism::see(VolumeContraction(model, set).bounded_value(model.points), exact,
                   pessimism.fast);
  }
  if (with_published) {
    Pessimism::see(theta_bounded_volume(model, model.points), exact, pessimism.published);
  }
}

TEST(FourMethods, AllPairsOfDegreesUpToSix) {
  std::mt19937 random(851);
  Pessimism pessimism;
  for (int du = 1; du <= 6; ++du) {
    for (int dv = 1; dv <= 6; ++dv) {
      const PatchModel model = random_patch(random, {du, dv, (du + dv) % 3, du % 2});
      compare(model, du + dv <= 9, pessimism);
      if (du + dv <= 4) {
        EXPECT_EQ(exact_theta_volume(model, model.points), ExactVolume(model).value(model.points));
      }
    }
  }
}

TEST(FourMethods, HighDegrees) {
  std::mt19937 random(852);
  Pessimism pessimism;
  for (const auto& [du, dv] : {std::pair{13, 7}, std::pair{22, 1}, std::pair{1, 22}}) {
    compare(random_patch(random, {du, dv, 0, 0}), false, pessimism);
  }
  // The published sums have (2d + 1)^4 terms a pole: on one span of degrees 7 x 2 they end.
  compare(random_patch(random, {7, 2, 0, 0}), true, pessimism);
}

TEST(FourMethods, FromOneSpanToAThousand) {
  std::mt19937 random(853);
  Pessimism pessimism;
  for (int breaks : {0, 1, 9, 99, 999}) {
    compare(random_patch(random, {2, 1, breaks, 0}), true, pessimism);
    compare(random_patch(random, {1, 3, 0, breaks}), breaks < 100, pessimism);
  }
}

TEST(FourMethods, TenThousandRandomPatches) {
  std::mt19937 random(854);
  Pessimism pessimism;
  for (int round = 0; round < 10000; ++round) {
    const Shape shape{1 + round % 3, 1 + (round / 3) % 3, static_cast<int>(random() % 3),
                      static_cast<int>(random() % 2)};
    compare(random_patch(random, shape), round % 20 == 0, pessimism);
    if (HasFatalFailure()) return;
  }
  const double median = Pessimism::median(pessimism.printed);
  testing::Worst worst("median_pessimism_of_the_printed_bound", 100.0);
  EXPECT_TRUE(worst.see(median));
  testing::Worst fast("median_pessimism_fast", 1e5), gauss("median_pessimism_gauss", 1e5),
      published("median_pessimism_published", 1e6);
  EXPECT_TRUE(fast.see(Pessimism::median(pessimism.fast)));
  EXPECT_TRUE(gauss.see(Pessimism::median(pessimism.gauss)));
  EXPECT_TRUE(published.see(Pessimism::median(pessimism.published)));
}

}  // namespace
}  // namespace isochor
