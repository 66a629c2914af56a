// The bounds of patches with weights against quadrature with fifty digits.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <random>
#include <tuple>

#include "isochor/volume/volume_form.h"
#include "support/fine_quadrature.h"
#include "support/models.h"
#include "support/splines.h"
#include "support/worst.h"

namespace isochor {
namespace {

using Fifty = boost::multiprecision::cpp_bin_float_50;

using testing::fine_volume;
using testing::Worst;

// One open patch whose weights have logarithms spread evenly, the extremes at random places.
PatchModel weighted_patch(std::mt19937& random, const KnotVector& u, const KnotVector& v,
                          double ratio) {
  PatchModel model = testing::make_separate_model({testing::random_surface(random, u, v, false)});
  std::vector<double>& weights = model.patches[0].weights;
  for (size_t k = 0; k < model.points.size(); ++k) {
    weights.push_back(std::exp(testing::uniform(random, 0.0, std::log(ratio))));
  }
  weights[random() % weights.size()] = 1.0;
  weights[random() % weights.size()] = ratio;
  return model;
}

PatchModel weighted_bezier(std::mt19937& random, int du, int dv, double ratio) {
  return weighted_patch(random, KnotVector::uniform(du, 1), KnotVector::uniform(dv, 1), ratio);
}

double median_of(std::vector<double> numbers) {
  std::nth_element(numbers.begin(), numbers.begin() + numbers.size() / 2, numbers.end());
  return numbers[numbers.size() / 2];
}

// The error of a computed number; the oracle with eighty bits is right to 1e-18.
double error_of(const Bounded& computed, long double oracle) {
  return static_cast<double>(std::abs(static_cast<long double>(computed.value) - oracle));
}

TEST(RationalBound, FiftyDigits) {
  std::mt19937 random(511);
  Worst part("error_over_bound", 1.0);
  for (const auto& [du, dv, ratio] :
       {std::tuple{3, 1, 10.0}, std::tuple{2, 2, 10.0}, std::tuple{2, 1, 100.0}}) {
    const PatchModel model = weighted_bezier(random, du, dv, ratio);
    const Bounded computed = VolumeForm(model).bounded_value(model.points);
    const Surface surface = model.surface(0);
    const Fifty oracle = fine_volume<Fifty>(surface, 15, 5);
    const Fifty error = abs(Fifty(computed.value) - oracle);
    EXPECT_TRUE(part.see((error / computed.bound).convert_to<double>())) << ratio;
    EXPECT_LT(error, 1e-15);
    // The oracle itself: other rules, and the shorter type that the other tests use.
    EXPECT_LT(abs(oracle - Fifty(fine_volume<long double>(surface, 24, 4))), 1e-18);
    EXPECT_LT(abs(oracle - Fifty(fine_volume<long double>(surface, 24, 6))), 1e-18);
  }
}

TEST(RationalBound, RandomWeightsOfAllRatiosAndDegrees) {
  std::mt19937 random(512);
  Worst part("error_over_bound", 1.0);
  Worst relative("bound_over_size", 1e-11);
  std::vector<double> pessimism;
  for (double ratio : {1.5, 3.0, 10.0, 100.0}) {
    for (const auto& [du, dv] :
         {std::pair{2, 2}, std::pair{3, 3}, std::pair{2, 3}, std::pair{1, 4}}) {
      for (int round = 0; round < 3; ++round) {
        const PatchModel model = weighted_bezier(random, du, dv, ratio);
        const Bounded computed = VolumeForm(model).bounded_value(model.points);
        const double error = error_of(computed, fine_volume<long double>(model.surface(0), 24, 5));
        EXPECT_TRUE(part.see(error / computed.bound)) << ratio << ' ' << du << ' ' << dv;
        // Poles fill the box [-1, 1]^3, so that one is the size of the patch's volume.
        EXPECT_TRUE(relative.see(computed.bound)) << ratio << ' ' << du << ' ' << dv;
        pessimism.push_back(computed.bound / std::max(error, 1e-18));
      }
    }
  }
  RecordProperty("median_pessimism", std::to_string(median_of(pessimism)));
}

TEST(RationalBound, ManySpansWithMultipleKnotsAndUnclampedOnes) {
  std::mt19937 random(513);
  for (double ratio : {3.0, 100.0}) {
    const PatchModel model = weighted_patch(random, testing::random_clamped(random, 2, 2),
                                            testing::random_unclamped(random, 3, 2), ratio);
    const Bounded computed = VolumeForm(model).bounded_value(model.points);
    const double error = error_of(computed, fine_volume<long double>(model.surface(0), 20, 4));
    EXPECT_LE(error, computed.bound) << ratio;
    EXPECT_LT(computed.bound, 1e-11);
  }
}

TEST(RationalBound, HoldsAfterMovesOfAnySize) {
  std::mt19937 random(514);
  for (double ratio : {3.0, 100.0}) {
    PatchModel model = weighted_bezier(random, 3, 2, ratio);
    const VolumeForm form(model);  // made for the first shape, kept for all the others
    const std::vector<Vec3> before = model.points;
    const long double at_rest = fine_volume<long double>(model.surface(0), 24, 5);
    for (double size : {1e-6, 1.0, 1e3}) {
      for (Vec3& p : model.points) {
        for (int axis = 0; axis < 3; ++axis) p[axis] += size * testing::uniform(random, -1, 1);
      }
      const long double moved = fine_volume<long double>(model.surface(0), 24, 5);
      const Bounded value = form.bounded_value(model.points);
      EXPECT_LE(error_of(value, moved), value.bound) << ratio << ' ' << size;
      const Bounded change = form.bounded_change(before, model.points, form.whole());
      EXPECT_LE(error_of(change, moved - at_rest), change.bound) << ratio << ' ' << size;
      EXPECT_LT(change.bound, 1e-11 * std::max(size, size * size * size));
      model.points = before;
    }
  }
}

TEST(RationalBound, ChangesOfAFewPointsKeepTheirDigits) {
  std::mt19937 random(515);
  const PatchModel model = weighted_bezier(random, 3, 3, 100.0);
  const VolumeForm form(model);
  const Support support = form.support_of({5, 6});
  auto moved = model.points;
  for (int id : support.points) moved[static_cast<size_t>(id)] += Vec3(1e-5, -2e-5, 3e-5);
  const Bounded change = form.bounded_change(model.points, moved, support);
  PatchModel after = model;
  after.points = moved;
  const Fifty exact =
      fine_volume<Fifty>(after.surface(0), 14, 3) - fine_volume<Fifty>(model.surface(0), 14, 3);
  EXPECT_LE(abs(Fifty(change.value) - exact), change.bound);
  EXPECT_NEAR(change.value / exact.convert_to<double>(), 1.0, 1e-10);
  EXPECT_LT(change.bound, 1e-15);
}

TEST(RationalBound, ClosedModelsKeepTheirLaws) {
  testing::RandomModelOptions options;
  options.weight_ratio = 100.0;
  options.degrees[0] = options.degrees[1] = options.degrees[2] = 2;
  options.spans = 2;
  PatchModel model = testing::random_closed_model(516, options);
  const VolumeForm form(model);
  const Bounded value = form.bounded_value(model.points);
  EXPECT_LT(value.bound, 1e-11);
  testing::translate(model, Vec3(0.5, -0.25, 0.125));
  const Bounded shifted = form.bounded_value(model.points);
  EXPECT_LE(std::abs(shifted.value - value.value), value.bound + shifted.bound);
  EXPECT_NEAR(shifted.value, value.value, 1e-14);
  const Eigen::AngleAxisd turn(0.9, Vec3(2, -1, 0.4).normalized());
  testing::transform(model, turn.toRotationMatrix());
  const Bounded turned = form.bounded_value(model.points);
  EXPECT_LE(std::abs(turned.value - value.value), value.bound + turned.bound);
  EXPECT_NEAR(turned.value, value.value, 1e-14);
  // The gradients of a closed model add up to nothing.
  Vec3 sum = Vec3::Zero();
  for (const Vec3& row : form.gradient(model.points)) sum += row;
  EXPECT_LT(sum.norm(), 1e-14);
}

}  // namespace
}  // namespace isochor
