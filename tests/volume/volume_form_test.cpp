#include "isochor/volume/volume_form.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isochor/base/error.h"
#include "isochor/bspline/refinement.h"
#include "support/models.h"
#include "support/worst.h"

namespace isochor {
namespace {

using testing::make_cube_model;
using testing::random_closed_model;
using testing::random_open_patch;
using testing::RandomModelOptions;
using testing::Worst;

// Closed models of different kinds: mixed degrees, with weights, periodic, with poles and seam.
std::vector<PatchModel> closed_models() {
  std::vector<PatchModel> models;
  RandomModelOptions options;
  models.push_back(random_closed_model(1, options));
  options.degrees[0] = 1;
  options.degrees[2] = 5;
  models.push_back(random_closed_model(2, options));
  options.weight_ratio = 2.0;
  models.push_back(random_closed_model(3, options));
  models.push_back(testing::make_periodic_torus(3, 2, 7, 6));
  models.push_back(testing::make_sphere(1.0));
  models.push_back(testing::make_cylinder(0.5, 1.5));
  return models;
}

std::vector<Vec3> shifted(const std::vector<Vec3>& points, const Vec3& t) {
  std::vector<Vec3> result = points;
  for (Vec3& p : result) p += t;
  return result;
}

std::vector<Vec3> random_vectors(std::mt19937& random, size_t count) {
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  std::vector<Vec3> vectors(count);
  for (Vec3& p : vectors) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = coordinate(random);
  }
  return vectors;
}

double inner(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

TEST(VolumeForm, ModelsAreOrientedOutwards) {
  for (const PatchModel& model : closed_models()) {
    EXPECT_GT(VolumeForm(model).value(model.points), 0.1) << model.patches[0].name;
  }
}

TEST(VolumeForm, UnitCubeOfSixBicubicPatches) {
  const PatchModel cube = make_cube_model(3, 12);
  ASSERT_EQ(cube.patches.front().u_size(), 15);
  EXPECT_NEAR(VolumeForm(cube).value(cube.points), 1.0, 1e-15);
}

TEST(VolumeForm, Translation) {
  Worst worst("translation", 1e-13);
  for (const PatchModel& model : closed_models()) {
    const VolumeForm form(model);
    const double value = form.value(model.points);
    const double moved = form.value(shifted(model.points, Vec3(3.0, -1.5, 2.25)));
    EXPECT_TRUE(worst.see(std::abs(moved - value))) << model.patches[0].name;
  }
}

TEST(VolumeForm, LinearMap) {
  Eigen::Matrix3d matrix;
  matrix << 1.2, 0.3, -0.4, 0.1, -0.9, 0.5, 0.7, 0.2, 0.6;
  Worst worst("linear_map", 1e-13);
  for (PatchModel model : closed_models()) {
    const VolumeForm form(model);
    const double value = form.value(model.points);
    testing::transform(model, matrix);
    const double expected = matrix.determinant() * value;
    EXPECT_TRUE(worst.see(std::abs(form.value(model.points) - expected)));
  }
}

TEST(VolumeForm, Orientation) {
  for (PatchModel model : closed_models()) {
    const double value = VolumeForm(model).value(model.points);
    for (Patch& patch : model.patches) patch.reversed = !patch.reversed;
    EXPECT_EQ(VolumeForm(model).value(model.points), -value);
  }
  // Swapping u and v reverses a patch, too.
  PatchModel sheet = random_open_patch(4, 2, 3, 2);
  const double value = VolumeForm(sheet).value(sheet.points);
  const Patch& old = sheet.patches[0];
  Patch swapped = old;
  std::swap(swapped.u_knots, swapped.v_knots);
  swapped.points.clear();
  for (int j = 0; j < old.v_size(); ++j) {
    for (int i = 0; i < old.u_size(); ++i) swapped.points.push_back(old.point(i, j));
  }
  sheet.patches[0] = swapped;
  EXPECT_NEAR(VolumeForm(sheet).value(sheet.points), -value, 1e-15);
}

TEST(VolumeForm, Linearity) {
  Worst worst("linearity", 1e-14);
  std::mt19937 random(31);
  for (const PatchModel& model : closed_models()) {
    const VolumeForm form(model);
    for (int axis = 0; axis < 3; ++axis) {
      auto other = model.points;
      auto mixed = model.points;
      const auto steps = random_vectors(random, other.size());
      for (size_t i = 0; i < other.size(); ++i) {
        other[i][axis] += steps[i][axis];
        mixed[i][axis] += 0.25 * steps[i][axis];
      }
      const double expected = 0.75 * form.value(model.points) + 0.25 * form.value(other);
      EXPECT_TRUE(worst.see(std::abs(form.value(mixed) - expected))) << axis;
    }
  }
}

TEST(VolumeForm, Locality) {
  Worst worst("locality", 1e-14);
  std::vector<PatchModel> models = closed_models();
  models.push_back(random_open_patch(5, 3, 2, 4, true));
  for (const PatchModel& model : models) {
    const VolumeForm form(model);
    const Support support = form.support_of({7, 3, 7, 11});
    EXPECT_EQ(support.points, (std::vector<int>{3, 7, 11}));
    auto moved = model.points;
    for (int id : support.points) moved[static_cast<size_t>(id)] += Vec3(0.1, -0.2, 0.3);
    const double global = form.value(moved) - form.value(model.points);
    const double local = form.value(moved, support) - form.value(model.points, support);
    EXPECT_TRUE(worst.see(std::abs(local - global)));
    EXPECT_TRUE(worst.see(std::abs(form.change(model.points, moved, support) - global)));
    const auto rows = form.gradient(model.points, support);
    const auto all = form.gradient(model.points);
    ASSERT_EQ(rows.size(), support.points.size());
    for (size_t row = 0; row < rows.size(); ++row) {
      EXPECT_EQ(rows[row], all[static_cast<size_t>(support.points[row])]);
    }
  }
}

TEST(VolumeForm, SupportIsExactlyWhereThePointActs) {
  const PatchModel cube = make_cube_model(3, 12);
  const VolumeForm form(cube);
  const Patch& top = cube.patches[0];
  EXPECT_EQ(form.support_of({top.point(7, 7)}).elements.size(), 16u);
  EXPECT_EQ(form.support_of({top.point(0, 7)}).elements.size(), 8u);  // two faces, 1 x 4 each
  EXPECT_EQ(form.support_of({top.point(0, 0)}).elements.size(), 3u);  // a corner of three faces
  EXPECT_EQ(form.support_of({}).elements.size(), 0u);
  EXPECT_EQ(form.whole().elements.size(), 6u * 144u);
  EXPECT_EQ(form.support_of(form.whole().points).elements, form.whole().elements);
}

TEST(VolumeForm, Gradient) {
  // V is affine in each coordinate, so a difference of any width is exact but for rounding.
  Worst worst("difference", 1e-14);
  std::vector<PatchModel> models = closed_models();
  models.push_back(random_open_patch(6, 4, 1, 3));
  models.push_back(random_open_patch(7, 2, 3, 3, true));
  models.push_back(models.back());
  models.back().patches[0].reversed = true;
  for (const PatchModel& model : models) {
    const VolumeForm form(model);
    const ValueAndGradient at = form.value_and_gradient(model.points);
    EXPECT_EQ(at.value, form.value(model.points));
    for (size_t i = 0; i < model.points.size(); i += 1 + model.points.size() / 8) {
      for (int axis = 0; axis < 3; ++axis) {
        auto high = model.points;
        auto low = model.points;
        high[i][axis] += 0.5;
        low[i][axis] -= 0.5;
        const double slope = form.value(high) - form.value(low);
        EXPECT_TRUE(worst.see(std::abs(at.gradient[i][axis] - slope)));
      }
    }
  }
}

TEST(VolumeForm, LineCubicIsTheWholePolynomial) {
  std::mt19937 random(32);
  for (const PatchModel& model : closed_models()) {
    const VolumeForm form(model);
    const auto directions = random_vectors(random, model.points.size());
    const LineCubic line = form.line_cubic(model.points, directions, form.whole());
    EXPECT_NEAR(line.linear, inner(form.gradient(model.points), directions), 1e-12);
    EXPECT_NEAR(line.cubic, form.value(directions), 1e-12);
    for (double s : {-1.0, 0.5, 2.0}) {
      auto moved = model.points;
      for (size_t i = 0; i < moved.size(); ++i) moved[i] += s * directions[i];
      EXPECT_NEAR(line.change(s), form.value(moved) - form.value(model.points), 1e-12);
      EXPECT_NEAR(line.slope(s), inner(form.gradient(moved), directions), 1e-12);
    }
  }
}

TEST(VolumeForm, Knots) {
  const PatchModel coarse = random_open_patch(8, 3, 2, 3);
  const Surface surface = coarse.surface(0);
  for (bool in_u : {true, false}) {
    const auto finer_knots = [](const KnotVector& knots, bool insert) {
      return insert ? with_knots(knots, {0.123, 0.5, 0.5, 0.77}) : knots;
    };
    const Surface finer = refine(surface, finer_knots(surface.u_knots(), in_u),
                                 finer_knots(surface.v_knots(), !in_u));
    PatchModel fine;
    fine.points = finer.poles();
    Patch patch = coarse.patches[0];
    patch.u_knots = finer.u_knots();
    patch.v_knots = finer.v_knots();
    patch.points.clear();
    for (size_t k = 0; k < fine.points.size(); ++k) patch.points.push_back(static_cast<int>(k));
    fine.patches.push_back(patch);
    ASSERT_GT(fine.points.size(), coarse.points.size());
    EXPECT_NEAR(VolumeForm(fine).value(fine.points), VolumeForm(coarse).value(coarse.points),
                1e-15);
  }
}

TEST(VolumeForm, DegeneratePatchesHaveNoVolume) {
  PatchModel model = make_cube_model(2, 3);
  for (Vec3& p : model.points) p = Vec3(0.3, -0.2, 0.7);
  const VolumeForm form(model);
  EXPECT_EQ(form.value(model.points), 0.0);
  for (const Vec3& row : form.gradient(model.points)) EXPECT_EQ(row, Vec3::Zero());
}

TEST(VolumeForm, ScaleOfTheModelDoesNotMatter) {
  const PatchModel model = random_closed_model(9);
  const VolumeForm form(model);
  const double value = form.value(model.points);
  for (double size : {0x1p-30, 0x1p30}) {
    auto scaled = model.points;
    for (Vec3& p : scaled) p *= size;
    EXPECT_EQ(form.value(scaled), value * size * size * size);
  }
}

TEST(VolumeForm, NotANumberIsNotHidden) {
  PatchModel model = make_cube_model(1, 2);
  const VolumeForm form(model);
  model.points[3].y() = std::nan("");
  EXPECT_TRUE(std::isnan(form.value(model.points)));
  EXPECT_TRUE(std::isnan(form.bounded_value(model.points).bound));
}

TEST(VolumeForm, TablesThatDoNotFitAreTheCallersBug) {
  const PatchModel model = make_cube_model(1, 2);
  const VolumeForm form(model);
  const std::vector<Vec3> short_table(3, Vec3::Zero());
  EXPECT_THROW(static_cast<void>(form.value(short_table)), PreconditionError);
  EXPECT_THROW(static_cast<void>(form.gradient(short_table)), PreconditionError);
  EXPECT_THROW(static_cast<void>(form.change(model.points, short_table, form.whole())),
               PreconditionError);
  EXPECT_THROW(static_cast<void>(form.support_of({-1})), PreconditionError);
  EXPECT_THROW(static_cast<void>(form.support_of({form.point_count()})), PreconditionError);
  PatchModel broken = model;
  broken.patches[0].points[0] = 1000;
  EXPECT_THROW(VolumeForm{broken}, PreconditionError);
}

TEST(VolumeForm, NoPatches) {
  const VolumeForm form{PatchModel()};
  EXPECT_EQ(form.point_count(), 0);
  EXPECT_EQ(form.value({}), 0.0);
}

}  // namespace
}  // namespace isochor
