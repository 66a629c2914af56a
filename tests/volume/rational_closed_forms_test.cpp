// Patches with weights whose volume is known: closed forms, and polynomial patches in disguise.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "isochor/base/tolerance.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/span_table.h"
#include "isochor/volume/volume_form.h"
#include "support/models.h"
#include "support/revolved.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::make_rational_torus;
using ::isochor::testing::make_revolved;

const double kPi = std::acos(-1.0);

void expect_volume(const PatchModel& model, double expected) {
  const Bounded computed = VolumeForm(model).bounded_value(model.points);
  EXPECT_NEAR(computed.value, expected, 4e-15 * std::abs(expected));
  // The closed form is rounded, and so are the poles and weights (1 / sqrt 2).
  EXPECT_LE(std::abs(computed.value - expected), computed.bound + 4e-15 * std::abs(expected));
  EXPECT_LT(computed.bound, 2e-12 * std::abs(expected));
}

TEST(RationalClosedForms, TorusConeAndFrustum) {
  for (const auto& [major, minor] : {std::pair{2.0, 0.5}, std::pair{5.0, 4.0}}) {
    expect_volume(make_rational_torus(major, minor), 2 * kPi * kPi * major * minor * minor);
  }
  const KnotVector two = KnotVector::clamped(1, {0, 1, 2});
  expect_volume(make_revolved(two, {{0, 0}, {1.5, 0}, {0, 4}}), kPi * 2.25 * 4 / 3);
  const KnotVector three = KnotVector::clamped(1, {0, 1, 2, 3});
  expect_volume(make_revolved(three, {{0, -1}, {3, -1}, {2, 1}, {0, 1}}),
                kPi * 2.0 * (9 + 6 + 4) / 3);
}

// The second theorem of Pappus: the area of the profile times the way of its centroid.
TEST(RationalClosedForms, RingsOfPolygonsByPappus) {
  std::mt19937 random(421);
  for (int round = 0; round < 8; ++round) {
    const int corners = 3 + round % 4;
    std::vector<std::pair<double, double>> profile;
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * kPi * k / corners + testing::uniform(random, -0.3, 0.3);
      profile.emplace_back(4 + 1.5 * std::cos(angle), 1.5 * std::sin(angle));
    }
    profile.push_back(profile.front());
    double moment = 0.0;  // integral of the radius over the profile's area
    for (size_t k = 0; k + 1 < profile.size(); ++k) {
      const auto [r, z] = profile[k];
      const auto [s, y] = profile[k + 1];
      moment += (y - z) * (r * r + r * s + s * s) / 6;
    }
    std::vector<double> breaks(profile.size());
    std::iota(breaks.begin(), breaks.end(), 0.0);
    expect_volume(make_revolved(KnotVector::clamped(1, breaks), profile), 2 * kPi * moment);
  }
}

TEST(RationalClosedForms, EllipsoidsAndShearedCylinders) {
  PatchModel ellipsoid = testing::make_sphere(1.0);
  testing::transform(ellipsoid, Eigen::Vector3d(3.0, 0.25, 1.5).asDiagonal());
  expect_volume(ellipsoid, 4 * kPi / 3 * 3.0 * 0.25 * 1.5);
  PatchModel sheared = testing::make_cylinder(1.0, 2.0);
  Eigen::Matrix3d shear;
  shear << 1, 0.5, 2, 0, 1, -1, 0, 0, 1;
  testing::transform(sheared, shear);
  expect_volume(sheared, 2 * kPi);
  // Turned about any axis the rule and its bound serve as well.
  const Eigen::AngleAxisd turn(1.3, Vec3(-1, 2, 0.3).normalized());
  testing::transform(ellipsoid, turn.toRotationMatrix());
  expect_volume(ellipsoid, 4 * kPi / 3 * 3.0 * 0.25 * 1.5);
}

TEST(RationalClosedForms, ATorusHasTheGradientOfItsRadii) {
  // dV/dR along the direction in which the major radius grows, dV/dr the minor one.
  const double major = 3.0;
  const double minor = 1.0;
  const PatchModel torus = make_rational_torus(major, minor);
  const PatchModel wider = make_rational_torus(major + 1.0, minor);
  const PatchModel thicker = make_rational_torus(major, minor + 1.0);
  const auto gradient = VolumeForm(torus).gradient(torus.points);
  double by_major = 0.0;
  double by_minor = 0.0;
  for (size_t i = 0; i < gradient.size(); ++i) {
    by_major += gradient[i].dot(wider.points[i] - torus.points[i]);
    by_minor += gradient[i].dot(thicker.points[i] - torus.points[i]);
  }
  EXPECT_NEAR(by_major, 2 * kPi * kPi * minor * minor, 1e-12);
  EXPECT_NEAR(by_minor, 4 * kPi * kPi * major * minor, 1e-12);
}

// A Bezier patch under the Moebius map t -> c t / (1 - t + c t) keeps its shape and gets the
// weights c^i: a rational patch whose volume is the rational number of the polynomial one.
PatchModel disguised(const PatchModel& polynomial, double cu, double cv) {
  PatchModel model = polynomial;
  Patch& patch = model.patches[0];
  for (int i = 0; i < patch.u_size(); ++i) {
    for (int j = 0; j < patch.v_size(); ++j) {
      patch.weights.push_back(std::pow(cu, i) * std::pow(cv, j));
    }
  }
  return model;
}

TEST(RationalClosedForms, DisguisedPolynomialsKeepValueGradientAndBound) {
  std::mt19937 random(422);
  for (int round = 0; round < 12; ++round) {
    const int du = 1 + round % 4;
    const int dv = 1 + round % 3;
    PatchModel plain = testing::make_separate_model({testing::random_surface(
        random, KnotVector::uniform(du, 1), KnotVector::uniform(dv, 1), false)});
    const double cu = round % 2 == 0 ? 2.0 : 0.25;
    const double cv = round % 3 == 0 ? 1.0 : 4.0;
    const PatchModel rational = disguised(plain, cu, cv);
    const VolumeForm form(rational);
    const ExactVolume exact(plain);
    const Rational volume = exact.value(plain.points);
    const Bounded computed = form.bounded_value(rational.points);
    EXPECT_LE((Rational(computed.value) - volume).abs().to_double(), computed.bound) << round;
    EXPECT_LT(computed.bound, 1e-10);
    const auto rows = form.gradient(rational.points);
    const auto exact_rows = exact.gradient(plain.points);
    for (size_t i = 0; i < rows.size(); ++i) {
      for (size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(rows[i][static_cast<int>(axis)], exact_rows[i][axis].to_double(), 1e-13);
      }
    }
    auto moved = rational.points;
    moved[0] += Vec3(1e-7, -2e-7, 3e-7);
    moved.back() += Vec3(-1e-7, 1e-7, 5e-7);
    const Bounded change = form.bounded_change(rational.points, moved, form.whole());
    const Rational exact_change = exact.change(plain.points, moved);
    EXPECT_LE((Rational(change.value) - exact_change).abs().to_double(), change.bound);
    EXPECT_LT(change.bound, 1e-16);
  }
}

TEST(RationalClosedForms, StrongDisguisesAreBoundedHonestly) {
  // c = 64 crowds the parameters towards one end: the rule grows or the bound says so.
  std::mt19937 random(423);
  for (int round = 0; round < 6; ++round) {
    PatchModel plain = testing::make_separate_model({testing::random_surface(
        random, KnotVector::uniform(2, 1), KnotVector::uniform(1 + round % 3, 1), false)});
    const PatchModel rational = disguised(plain, 64.0, 1.0 / 16.0);
    const VolumeForm form(rational);
    const Rational volume = ExactVolume(plain).value(plain.points);
    const Bounded computed = form.bounded_value(rational.points);
    EXPECT_GT(form.gauss_points(0).first, exact_gauss_points(2));
    EXPECT_LE((Rational(computed.value) - volume).abs().to_double(), computed.bound) << round;
  }
}

TEST(RationalClosedForms, CommonFactorsOfTheWeightsChangeNothing) {
  testing::RandomModelOptions options;
  options.weight_ratio = 4.0;
  const PatchModel model = testing::random_closed_model(424, options);
  const double value = VolumeForm(model).value(model.points);
  for (double factor : {0x1p30, 0x1p-40, 3.0}) {
    PatchModel scaled = model;
    for (Patch& patch : scaled.patches) {
      for (double& w : patch.weights) w *= factor;
    }
    const VolumeForm form(scaled);
    EXPECT_EQ(form.gauss_points(0), VolumeForm(model).gauss_points(0));
    if (factor == 3.0) {
      EXPECT_NEAR(form.value(model.points), value, 1e-14);
    } else {
      EXPECT_EQ(form.value(model.points), value) << "powers of two change no bit";
    }
  }
}

// The rim of an open patch with weights, far from the origin: lifting by t adds t times the
// projected area, which the gradient in z knows, too.
TEST(RationalClosedForms, OpenPatchesFarAwayKeepTheirMeaning) {
  std::mt19937 random(425);
  for (const bool unclamped : {false, true}) {
    const KnotVector u = unclamped ? testing::random_unclamped(random, 2, 2)
                                   : testing::random_clamped(random, 2, 2, 1);
    const Surface surface =
        testing::random_surface(random, u, testing::random_clamped(random, 2, 1, 1), true);
    PatchModel near = testing::make_separate_model({surface});
    near.patches[0].reversed = unclamped;
    for (Vec3& p : near.points) p = (p * 4096.0).array().round() / 4096.0;
    const VolumeForm near_form(near);
    double area = 0.0;
    for (const Vec3& row : near_form.gradient(near.points)) area += row.z();
    for (double lift : {64.0, 4096.0}) {
      PatchModel far = near;
      testing::translate(far, Vec3(0, 0, lift));
      const VolumeForm far_form(far);
      const Bounded computed = far_form.bounded_value(far.points);
      const double expected = near_form.value(near.points) + lift * area;
      EXPECT_NEAR(computed.value, expected, 1e-13 * lift);
      EXPECT_LE(std::abs(computed.value - expected), computed.bound + 1e-14 * lift);
      const auto rows = far_form.gradient(far.points);
      const auto plain = near_form.gradient(far.points);  // measured from zero, all the same
      for (size_t i = 0; i < rows.size(); ++i) {
        EXPECT_LT((rows[i] - plain[i]).norm(), 1e-13 * lift);
      }
      const Support corner = far_form.support_of({0});
      auto moved = far.points;
      moved[0] += Vec3(0.25, -0.125, 0.5);
      const Bounded change = far_form.bounded_change(far.points, moved, corner);
      EXPECT_NEAR(change.value, near_form.change(far.points, moved, near_form.whole()),
                  1e-13 * lift);
      EXPECT_NEAR(far_form.change(far.points, moved, corner), change.value, 1e-13 * lift);
    }
  }
}

}  // namespace
}  // namespace isochor
