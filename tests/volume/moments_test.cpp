// The laws of moments.h, and bodies whose moments are known.
#include "isochor/volume/moments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "isochor/base/error.h"
#include "support/messages.h"
#include "support/models.h"
#include "support/revolved.h"
#include "support/worst.h"

namespace isochor {
namespace {

using ::isochor::testing::make_revolved;
using ::isochor::testing::Worst;

const double kPi = std::acos(-1.0);

Moments moments_of(const PatchModel& model) { return MomentForm(model).moments(model.points); }

Matrix3 turned() {
  return Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.7).normalized()).toRotationMatrix();
}

std::vector<PatchModel> bent_models() {
  testing::RandomModelOptions options;
  std::vector<PatchModel> models = {testing::random_closed_model(501, options)};
  options.degrees[0] = 1;
  options.degrees[1] = 2;
  options.spans = 2;
  models.push_back(testing::random_closed_model(502, options));
  options.weight_ratio = 3.0;
  models.push_back(testing::random_closed_model(503, options));
  models.push_back(testing::make_periodic_torus(3, 2, 7, 6));
  return models;
}

// Largest difference in units of the body: V, diagonal, V diagonal^2.
double difference(const Moments& a, const Moments& b, double size) {
  const double volume = std::abs(a.volume.value);
  return std::max({std::abs(a.volume.value - b.volume.value) / volume,
                   (a.centroid - b.centroid).norm() / size,
                   (a.second - b.second).norm() / (volume * size * size),
                   (a.inertia - b.inertia).norm() / (volume * size * size),
                   (a.principal - b.principal).norm() / (volume * size * size)});
}

TEST(Moments, Translation) {
  Worst worst("moments_translation", 2e-14);
  for (const PatchModel& model : bent_models()) {
    const Moments here = moments_of(model);
    PatchModel rounded = model;  // to a grid on which the shift is exact
    for (Vec3& p : rounded.points) p = (p * 0x1p24).array().round() / 0x1p24;
    const Moments before = moments_of(rounded);
    EXPECT_LT(difference(here, before, 1.0), 1e-6);
    const Vec3 shift(1048576.0, -524288.0, 2097152.0);
    testing::translate(rounded, shift);
    Moments after = moments_of(rounded);
    EXPECT_LT((after.centroid - shift - before.centroid).norm(), 1e-9);
    EXPECT_LE((after.centroid - shift - before.centroid).cwiseAbs().maxCoeff(),
              after.centroid_bound.maxCoeff() + before.centroid_bound.maxCoeff());
    after.centroid = before.centroid;
    EXPECT_TRUE(worst.see(difference(before, after, diagonal(model))));
  }
}

TEST(Moments, Rotation) {
  Worst worst("moments_rotation", 1e-14);
  const Matrix3 turn = turned();
  for (PatchModel model : bent_models()) {
    Moments expected = moments_of(model);
    testing::transform(model, turn);
    expected.centroid = turn * expected.centroid;
    expected.second = turn * expected.second * turn.transpose();
    expected.inertia = turn * expected.inertia * turn.transpose();
    EXPECT_TRUE(worst.see(difference(expected, moments_of(model), diagonal(model))));
  }
}

TEST(Moments, Scaling) {
  for (PatchModel model : bent_models()) {
    for (const double factor : {0x1p-30, 0x1p30}) {
      PatchModel scaled = model;
      testing::transform(scaled, Matrix3(Vec3::Constant(factor).asDiagonal()));
      const Moments before = moments_of(model);
      const Moments after = moments_of(scaled);
      EXPECT_DOUBLE_EQ(after.volume.value, before.volume.value * std::pow(factor, 3));
      EXPECT_LT((after.centroid / factor - before.centroid).norm(), 1e-15);
      EXPECT_LT((after.second / std::pow(factor, 5) - before.second).norm(),
                1e-14 * before.second.norm());
    }
  }
}

TEST(Moments, ReversingEveryPatchNegates) {
  for (PatchModel model : bent_models()) {
    const Moments before = moments_of(model);
    for (Patch& patch : model.patches) patch.reversed = !patch.reversed;
    const Moments after = moments_of(model);
    EXPECT_EQ(after.volume.value, -before.volume.value);
    EXPECT_EQ(after.centroid, before.centroid);
    EXPECT_EQ(after.second, Matrix3(-before.second));
  }
}

TEST(Moments, ParallelAxes) {
  for (const PatchModel& model : bent_models()) {
    const MomentForm form(model);
    const Moments best = form.moments(model.points);
    for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(3, -1, 2), Vec3(-40, 60, 10)}) {
      const Moments seen = moments_from(form.integrals(model.points, origin));
      const auto within = [](double a, double b, double bound, double other) {
        return std::abs(a - b) <= bound + other;
      };
      EXPECT_TRUE(
          within(seen.volume.value, best.volume.value, seen.volume.bound, best.volume.bound));
      for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(within(seen.centroid[i], best.centroid[i], seen.centroid_bound[i],
                           best.centroid_bound[i]));
        EXPECT_LT(seen.centroid_bound[i], 1e-7);
        for (int j = 0; j < 3; ++j) {
          EXPECT_TRUE(within(seen.second(i, j), best.second(i, j), seen.second_bound(i, j),
                             best.second_bound(i, j)));
          EXPECT_TRUE(within(seen.inertia(i, j), best.inertia(i, j), seen.inertia_bound(i, j),
                             best.inertia_bound(i, j)));
          EXPECT_LT(best.second_bound(i, j), 1e-10);
        }
      }
      EXPECT_TRUE(
          within(seen.principal[2], best.principal[2], seen.principal_bound, best.principal_bound));
    }
  }
}

// The measured body against what geometry says, to `digits` of its size and within the bounds.
void expect_body(const PatchModel& model, double volume, const Vec3& centroid,
                 const Matrix3& second, double digits = 1e-14) {
  const Moments m = moments_of(model);
  const double scale = volume * second.norm() / volume;
  // The closed form and the poles are rounded themselves.
  EXPECT_NEAR(m.volume.value, volume, digits * volume);
  EXPECT_LE(std::abs(m.volume.value - volume), m.volume.bound + 8e-15 * volume);
  EXPECT_LT((m.centroid - centroid).norm(), digits * (1.0 + diagonal(model)));
  EXPECT_LT((m.second - second).norm(), digits * scale);
  const Matrix3 inertia = second.trace() * Matrix3::Identity() - second;
  EXPECT_LT((m.inertia - inertia).norm(), 2 * digits * scale);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(m.centroid_bound[i], 1e-11 * diagonal(model));
    for (int j = 0; j < 3; ++j) {
      EXPECT_LE(std::abs(m.second(i, j) - second(i, j)), m.second_bound(i, j) + 8e-15 * scale);
      EXPECT_LT(m.second_bound(i, j), 1e-9 * scale);
    }
  }
}

TEST(MomentsClosedForms, AffineBoxes) {
  std::mt19937 random(504);
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  for (const auto& [degree, spans] : {std::pair{1, 1}, std::pair{2, 3}, std::pair{4, 1}}) {
    Matrix3 map;
    for (int k = 0; k < 9; ++k) map(k / 3, k % 3) = entry(random);
    map += 2.0 * Matrix3::Identity();
    PatchModel box = testing::make_cube_model(degree, spans);
    testing::transform(box, map);
    testing::translate(box, Vec3(1, 2, -3));
    const double volume = map.determinant();
    expect_body(box, volume, map * Vec3::Constant(0.5) + Vec3(1, 2, -3),
                volume / 12 * map * map.transpose());
  }
}

TEST(MomentsClosedForms, Ellipsoids) {
  const Vec3 axes(3.0, 0.5, 1.25);
  const double volume = 4 * kPi / 3 * axes.prod();
  const Matrix3 second = volume / 5 * Matrix3(axes.cwiseAbs2().asDiagonal());
  PatchModel model = testing::make_sphere(1.0);
  testing::transform(model, Matrix3(axes.asDiagonal()));
  expect_body(model, volume, Vec3::Zero(), second, 1e-13);
  const Matrix3 turn = turned();
  testing::transform(model, turn);
  testing::translate(model, Vec3(100, 0, -50));
  expect_body(model, volume, Vec3(100, 0, -50), turn * second * turn.transpose(), 1e-13);
  expect_body(testing::make_sphere(2.0), 32 * kPi / 3, Vec3::Zero(),
              128 * kPi / 15 * Matrix3::Identity(), 1e-13);
}

TEST(MomentsClosedForms, CylinderConeAndTorus) {
  const double r = 1.5;
  const double h = 4.0;
  const double cylinder = kPi * r * r * h;
  expect_body(testing::make_cylinder(r, h), cylinder, Vec3(0, 0, h / 2),
              cylinder * Matrix3(Vec3(r * r / 4, r * r / 4, h * h / 12).asDiagonal()), 1e-13);
  const double cone = cylinder / 3;
  const KnotVector two = KnotVector::clamped(1, {0, 1, 2});
  expect_body(make_revolved(two, {{0, 0}, {r, 0}, {0, h}}), cone, Vec3(0, 0, h / 4),
              cone * Matrix3(Vec3(3 * r * r / 20, 3 * r * r / 20, 3 * h * h / 80).asDiagonal()),
              1e-13);
  const double major = 3.0;
  const double minor = 1.25;
  const double torus = 2 * kPi * kPi * major * minor * minor;
  const double across = major * major / 2 + 3 * minor * minor / 8;
  expect_body(testing::make_rational_torus(major, minor), torus, Vec3::Zero(),
              torus * Matrix3(Vec3(across, across, minor * minor / 4).asDiagonal()), 1e-13);
}

TEST(Moments, PrincipalAxesOfABox) {
  const Vec3 sides(3.0, 2.0, 1.0);
  PatchModel box = testing::make_cube_model(2, 2);
  testing::transform(box, Matrix3(sides.asDiagonal()));
  const Matrix3 turn = turned();
  testing::transform(box, turn);
  const Moments m = moments_of(box);
  const Vec3 expected = sides.prod() / 12 * Vec3(4 + 1, 9 + 1, 9 + 4);
  EXPECT_LT((m.principal - expected).cwiseAbs().maxCoeff(), 1e-14 * expected[2]);
  EXPECT_LE((m.principal - expected).cwiseAbs().maxCoeff(), m.principal_bound);
  EXPECT_NEAR(m.axes.determinant(), 1.0, 1e-14);
  for (int k = 0; k < 3; ++k) {
    // Columns of the rotation, up to their sense.
    const double sine = m.axes.col(k).cross(turn.col(k)).norm();
    EXPECT_LE(sine, m.axis_bound[k]);
    EXPECT_LT(m.axis_bound[k], 1e-10);
    if (k == 2) continue;
    Eigen::Index largest = 0;
    m.axes.col(k).cwiseAbs().maxCoeff(&largest);
    EXPECT_GT(m.axes(largest, k), 0.0);
  }
}

TEST(Moments, AxesOfARoundBodyAreSaidToBeUnknown) {
  const Moments m = moments_of(testing::make_cylinder(1.0, 4.0));
  // The axis of least inertia is the cylinder's; the two across it are anybody's choice.
  EXPECT_LT((m.axes.col(0) - Vec3(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT(m.axis_bound[0], 1e-9);
  EXPECT_DOUBLE_EQ(m.axis_bound[1], kPi / 2);
  EXPECT_DOUBLE_EQ(m.axis_bound[2], kPi / 2);
}

TEST(Moments, GradientByCentralDifferences) {
  Worst worst("moments_gradient", 1e-8);
  std::mt19937 random(505);
  std::normal_distribution<double> normal;
  for (const PatchModel& model : bent_models()) {
    const MomentForm form(model);
    const MomentGradients gradient = form.gradients(model.points);
    for (int round = 0; round < 3; ++round) {
      const double step = 1e-4;
      auto ahead = model.points;
      auto behind = model.points;
      double volume = 0.0;
      Vec3 centroid = Vec3::Zero();
      std::array<double, 6> second{};
      for (size_t i = 0; i < model.points.size(); ++i) {
        const Vec3 d(normal(random), normal(random), normal(random));
        ahead[i] += step * d;
        behind[i] -= step * d;
        volume += gradient.volume[i].dot(d);
        for (size_t k = 0; k < 3; ++k)
          centroid[static_cast<int>(k)] += gradient.centroid[k][i].dot(d);
        for (size_t k = 0; k < 6; ++k) second[k] += gradient.second[k][i].dot(d);
      }
      const Moments a = form.moments(ahead);
      const Moments b = form.moments(behind);
      // The error of the difference is of order step^2 times the third derivative.
      EXPECT_TRUE(
          worst.see(0.1 * std::abs((a.volume.value - b.volume.value) / (2 * step) - volume)));
      EXPECT_TRUE(worst.see(0.1 * ((a.centroid - b.centroid) / (2 * step) - centroid).norm()));
      const Matrix3 change = (a.second - b.second) / (2 * step);
      const std::array<double, 6> seen = {change(0, 0), change(0, 1), change(0, 2),
                                          change(1, 1), change(1, 2), change(2, 2)};
      for (size_t k = 0; k < 6; ++k) EXPECT_TRUE(worst.see(0.1 * std::abs(seen[k] - second[k])));
    }
  }
}

// Moving all points together moves the centroid and nothing else; growing follows the powers.
TEST(Moments, GradientOfRigidMotionAndGrowth) {
  for (PatchModel model : bent_models()) {
    testing::translate(model, Vec3(5, -7, 11));
    const MomentForm form(model);
    const Moments m = form.moments(model.points);
    const MomentGradients gradient = form.gradients(model.points);
    const auto by_shift = [](const std::vector<Vec3>& rows) {
      Vec3 sum = Vec3::Zero();
      for (const Vec3& row : rows) sum += row;
      return sum;
    };
    const auto by_growth = [&](const std::vector<Vec3>& rows) {
      double sum = 0.0;
      for (size_t i = 0; i < rows.size(); ++i) sum += rows[i].dot(model.points[i] - m.centroid);
      return sum;
    };
    EXPECT_LT(by_shift(gradient.volume).norm(), 1e-13);
    EXPECT_NEAR(by_growth(gradient.volume), 3 * m.volume.value, 1e-13);
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_LT((by_shift(gradient.centroid[k]) - Vec3::Unit(static_cast<int>(k))).norm(), 1e-13);
      EXPECT_NEAR(by_growth(gradient.centroid[k]), 0.0, 1e-13);
    }
    for (size_t k = 0; k < 6; ++k) EXPECT_LT(by_shift(gradient.second[k]).norm(), 1e-13);
    EXPECT_NEAR(by_growth(gradient.second[0]), 5 * m.second(0, 0), 1e-13);
    EXPECT_NEAR(by_growth(gradient.second[4]), 5 * m.second(1, 2), 1e-13);
    const auto volume_rows = VolumeForm(model).gradient(model.points);
    for (size_t i = 0; i < volume_rows.size(); ++i) {
      EXPECT_LT((gradient.volume[i] - volume_rows[i]).norm(), 1e-13);
    }
  }
}

TEST(Moments, RulesAreExactOrRaised) {
  EXPECT_EQ(MomentForm(testing::make_cube_model(3, 1)).gauss_points(0), (std::pair{8, 8}));
  EXPECT_EQ(MomentForm(testing::make_cube_model(2, 1)).gauss_points(0), (std::pair{5, 5}));
  const PatchModel cylinder = testing::make_cylinder(1.0, 2.0);
  EXPECT_GT(MomentForm(cylinder).gauss_points(1).first, 12);
  EXPECT_GT(MomentForm(cylinder).gauss_points(0).first, 12) << "a disk in its own plane";
}

TEST(Moments, BodiesWithoutVolumeAreRefused) {
  PatchModel flat = testing::make_cube_model(2, 1);
  testing::transform(flat, Matrix3(Vec3(1, 1, 0).asDiagonal()));
  EXPECT_NE(
      testing::message_of<InputError>([&] { moments_of(flat); }).find("not different from zero"),
      std::string::npos);
  const MomentForm form(flat);
  EXPECT_THROW(form.moments({}), PreconditionError);
  EXPECT_THROW(form.gauss_points(6), PreconditionError);
  MomentIntegrals unknown;
  unknown.value[0] = std::nan("");
  EXPECT_THROW(moments_from(unknown), InputError);
  unknown.value[0] = 1.0;
  unknown.bound[0] = std::numeric_limits<double>::infinity();
  EXPECT_NE(testing::message_of<InputError>([&] { moments_from(unknown); }).find("does not close"),
            std::string::npos);
}

}  // namespace
}  // namespace isochor
