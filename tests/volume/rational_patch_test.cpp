// Patches with weights: closed forms, the choice of the rule, and the discrete functional.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "isochor/bspline/refinement.h"
#include "isochor/volume/volume_form.h"
#include "support/models.h"

namespace isochor {
namespace {

using testing::random_closed_model;
using testing::RandomModelOptions;

const double kPi = std::acos(-1.0);

TEST(RationalPatch, SphereAndCylinderAgainstClosedForms) {
  const PatchModel sphere = testing::make_sphere(2.0);
  const Bounded ball = VolumeForm(sphere).bounded_value(sphere.points);
  EXPECT_NEAR(ball.value, 32.0 * kPi / 3, 1e-13);
  EXPECT_LE(std::abs(ball.value - 32.0 * kPi / 3), ball.bound);
  EXPECT_LT(ball.bound, 2e-13 * ball.value);
  const PatchModel cylinder = testing::make_cylinder(1.5, 4.0);
  const Bounded drum = VolumeForm(cylinder).bounded_value(cylinder.points);
  EXPECT_NEAR(drum.value, 9.0 * kPi, 1e-13);
  EXPECT_LE(std::abs(drum.value - 9.0 * kPi), drum.bound);
}

TEST(RationalPatch, FarFromTheOrigin) {
  PatchModel sphere = testing::make_sphere(1.0);
  testing::translate(sphere, Vec3(0x1p20, -0x1p19, 0x1p20));
  const VolumeForm form(sphere);
  EXPECT_NEAR(form.value(sphere.points), 4.0 * kPi / 3, 1e-9);  // poles are rounded to 1e-10
  // The shift itself costs nothing: the same points shifted back, exactly, give the same value.
  PatchModel back = sphere;
  testing::translate(back, Vec3(-0x1p20, 0x1p19, -0x1p20));
  EXPECT_NEAR(VolumeForm(back).value(back.points), form.value(sphere.points), 1e-14);
}

TEST(RationalPatch, DirectionsWithoutWeightsKeepTheExactRule) {
  const PatchModel cylinder = testing::make_cylinder(1.0, 1.0);
  const auto [u, v] = VolumeForm(cylinder).gauss_points(0);
  EXPECT_GT(u, 8);
  EXPECT_EQ(v, 2);
}

TEST(RationalPatch, RuleGrowsWithTheWeightsAndNotWithTheShape) {
  RandomModelOptions options;
  int last = 0;
  for (double ratio : {1.0, 1.5, 10.0}) {
    options.weight_ratio = ratio;
    PatchModel model = random_closed_model(51, options);
    const int points = VolumeForm(model).gauss_points(0).first;
    EXPECT_GT(points, last) << ratio;
    last = points;
    for (Vec3& p : model.points) p.z() = 0.0;
    EXPECT_EQ(VolumeForm(model).gauss_points(0).first, points);
  }
}

TEST(RationalPatch, EqualWeightsAreNoWeights) {
  PatchModel model = random_closed_model(52);
  const double value = VolumeForm(model).value(model.points);
  for (Patch& patch : model.patches) patch.weights.assign(patch.points.size(), 3.0);
  EXPECT_EQ(VolumeForm(model).value(model.points), value);
}

TEST(RationalPatch, KnotInsertionChangesTheRuleButNotTheVolume) {
  PatchModel coarse = testing::random_open_patch(53, 3, 2, 2);
  Patch& patch = coarse.patches[0];
  for (size_t k = 0; k < patch.points.size(); ++k)
    patch.weights.push_back(static_cast<double>(1 + (k * k) % 3));
  const Surface surface = coarse.surface(0);
  const Surface finer = refine(surface, refined_to_spans(surface.u_knots(), 7),
                               refined_to_spans(surface.v_knots(), 6));
  PatchModel fine;
  fine.points = finer.poles();
  fine.patches = coarse.patches;
  fine.patches[0].u_knots = finer.u_knots();
  fine.patches[0].v_knots = finer.v_knots();
  fine.patches[0].weights = finer.weights();
  fine.patches[0].points.resize(fine.points.size());
  std::iota(fine.patches[0].points.begin(), fine.patches[0].points.end(), 0);
  const VolumeForm coarse_form(coarse);
  const VolumeForm fine_form(fine);
  EXPECT_LT(fine_form.gauss_points(0).first, coarse_form.gauss_points(0).first);
  const Bounded a = coarse_form.bounded_value(coarse.points);
  const Bounded b = fine_form.bounded_value(fine.points);
  EXPECT_LE(std::abs(a.value - b.value), a.bound + b.bound);
  EXPECT_NEAR(a.value, b.value, 1e-14);
}

TEST(RationalPatch, BoundTellsWhenTheCellsAreTooCoarse) {
  // Neighbouring weights 1 : 1e12 put the poles of the integrand next to the real axis, nearer than
  // cells may be cut.
  PatchModel sheet = testing::random_open_patch(54, 3, 3, 1);
  Patch& patch = sheet.patches[0];
  for (size_t k = 0; k < patch.points.size(); ++k) patch.weights.push_back(k % 2 == 0 ? 1.0 : 1e12);
  const VolumeForm form(sheet);
  EXPECT_GE(form.gauss_points(0).second, 100);
  EXPECT_LE(form.gauss_points(0).second, 1500);
  const Bounded computed = form.bounded_value(sheet.points);
  EXPECT_GT(computed.bound, 1.0);
  EXPECT_TRUE(std::isfinite(computed.bound));
}

TEST(RationalPatch, DiscreteFunctionalIsKeptByItsOwnGradient) {
  // Move along x only, within the plane that the discrete gradient allows: V stays to rounding,
  // although the quadrature error itself may be larger.
  PatchModel sheet = testing::random_open_patch(55, 2, 2, 3);
  Patch& patch = sheet.patches[0];
  for (size_t k = 0; k < patch.points.size(); ++k) patch.weights.push_back(k % 3 == 0 ? 50.0 : 1.0);
  const VolumeForm form(sheet);
  const auto gradient = form.gradient(sheet.points);
  double along = 0.0;
  double square = 0.0;
  for (size_t i = 0; i < gradient.size(); ++i) {
    along += std::sin(static_cast<double>(i)) * gradient[i].x();
    square += gradient[i].x() * gradient[i].x();
  }
  auto moved = sheet.points;
  for (size_t i = 0; i < gradient.size(); ++i) {
    moved[i].x() += std::sin(static_cast<double>(i)) - along / square * gradient[i].x();
  }
  EXPECT_NEAR(form.value(moved), form.value(sheet.points), 1e-15);
  EXPECT_NEAR(form.change(sheet.points, moved, form.whole()), 0.0, 1e-15);
}

}  // namespace
}  // namespace isochor
