#include "isochor/edit/displacement_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "edit/fixtures.h"
#include "isochor/base/error.h"

namespace isochor {
namespace {

using ::testing::HasSubstr;

using testing::at_scale;
using testing::dot;
using testing::mirrored;
using testing::prepared;
using testing::random_vectors;

TEST(DisplacementSpace, GatherIsTheTransposeOfExpand) {
  for (int every : {1, 2, 5}) {
    const PatchModel model = prepared(testing::make_cube_model(3, 10));
    const DisplacementSpace space(model, at_scale(every));
    const auto delta = random_vectors(1, static_cast<size_t>(space.size()));
    const auto gradient = random_vectors(2, model.points.size());
    const double there = dot(gradient, space.expand(delta));
    const double back = dot(space.gather(gradient), delta);
    EXPECT_NEAR(there, back, 1e-11 * (1.0 + std::abs(there))) << every;
  }
}

TEST(DisplacementSpace, TheSurfaceMovesAsItsRowSays) {
  for (double ratio : {1.0, 5.0}) {
    testing::RandomModelOptions options;
    options.spans = 5;
    options.weight_ratio = ratio;
    const PatchModel model = prepared(testing::random_closed_model(3, options));
    const DisplacementSpace space(model, at_scale(2));
    const auto delta = random_vectors(4, static_cast<size_t>(space.size()));
    PatchModel moved = model;
    const auto displacement = space.expand(delta);
    for (size_t i = 0; i < moved.points.size(); ++i) moved.points[i] += displacement[i];
    for (const Uv uv : {Uv{0.31, 0.77}, Uv{0.0, 0.5}, Uv{1.0, 1.0}}) {
      const CoefficientRow row = space.surface_row(model, 2, uv);
      Vec3 predicted = Vec3::Zero();
      for (size_t k = 0; k < row.coefficient.size(); ++k) {
        predicted += row.value[k].cwiseProduct(delta[static_cast<size_t>(row.coefficient[k])]);
      }
      const Vec3 got = moved.surface(2).point(uv.u, uv.v) - model.surface(2).point(uv.u, uv.v);
      EXPECT_LE((got - predicted).norm(), 1e-13 * (1.0 + predicted.norm()));
    }
  }
}

TEST(DisplacementSpace, TiedPointsGetTheSameBits) {
  PatchModel model = testing::make_cube_model(3, 6);
  // The same cube with points of its own for every patch, tied instead of shared.
  PatchModel tied = model;
  tied.points.clear();
  std::vector<int> first(model.points.size(), -1);
  for (Patch& patch : tied.patches) {
    for (int& id : patch.points) {
      const int shared = id;
      id = static_cast<int>(tied.points.size());
      tied.points.push_back(model.points[static_cast<size_t>(shared)] + Vec3::Constant(1e-9 * id));
      int& known = first[static_cast<size_t>(shared)];
      if (known < 0) {
        known = id;
      } else {
        tied.ties.emplace_back(known, id);
      }
    }
  }
  for (int every : {1, 3}) {
    const PatchModel ready = prepared(tied);
    const DisplacementSpace space(ready, at_scale(every));
    EXPECT_EQ(space.size(), DisplacementSpace(prepared(model), at_scale(every)).size());
    const auto moved = space.expand(random_vectors(5, static_cast<size_t>(space.size())));
    for (const auto& [a, b] : ready.ties) {
      EXPECT_EQ(moved[static_cast<size_t>(a)], moved[static_cast<size_t>(b)]);
    }
  }
}

TEST(DisplacementSpace, LockedPointsDoNotMoveAtAnyScale) {
  PatchModel model = prepared(testing::make_cube_model(3, 10));
  model.lock(model.patches[0].point(6, 6), "a window is here", false);
  for (int every : {1, 2, 4}) {
    const DisplacementSpace space(model, at_scale(every));
    std::vector<Vec3> delta = random_vectors(6, static_cast<size_t>(space.size()));
    int locked = 0;
    for (int c = 0; c < space.size(); ++c) {
      if (space.locked_axes(c) == 0) continue;
      EXPECT_EQ(space.locked_axes(c), 7u);
      EXPECT_EQ(space.lock_reason(c), "a window is here");
      delta[static_cast<size_t>(c)] = Vec3::Zero();
      ++locked;
    }
    EXPECT_GE(locked, 1);
    EXPECT_LE(locked, 16);
    EXPECT_EQ(space.expand(delta)[static_cast<size_t>(model.patches[0].point(6, 6))], Vec3::Zero());
  }
}

TEST(DisplacementSpace, ContinuityLocksAreLiftedByC0) {
  PatchModel model = prepared(testing::make_cube_model(3, 6));
  model.lock(model.patches[0].point(4, 4), "smooth join", true);
  DisplacementSpace::Options options = at_scale(1);
  const auto locked = [&] {
    const DisplacementSpace space(model, options);
    return space.locked_axes(space.coefficient(0, 4, 4));
  };
  EXPECT_EQ(locked(), 0u);
  options.continuity = Continuity::kMeasured;
  EXPECT_EQ(locked(), 7u);
}

TEST(DisplacementSpace, MirroredSpacesAreSmallerAndSymmetric) {
  PatchModel model = testing::make_cube_model(3, 7);
  testing::translate(model, Vec3(-0.5, 0.0, 0.0));
  DisplacementSpace::Options options = at_scale(1);
  const PatchModel ready = prepared(model);
  const int full = DisplacementSpace(ready, options).size();
  options.symmetry_axes = {0};
  const DisplacementSpace space(ready, options);
  double weights = 0.0;
  for (int c = 0; c < space.size(); ++c) weights += space.weight(c);
  EXPECT_EQ(static_cast<int>(weights), full);
  EXPECT_LT(space.size(), full * 3 / 5);
  const auto delta = random_vectors(8, static_cast<size_t>(space.size()));
  const auto gradient = random_vectors(9, ready.points.size());
  EXPECT_NEAR(dot(gradient, space.expand(delta)), dot(space.gather(gradient), delta), 1e-11);
}

TEST(DisplacementSpace, AsymmetricModelsAreNamed) {
  PatchModel model = testing::make_cube_model(3, 4);  // from 0 to 1: no mirror image in x
  DisplacementSpace::Options options = at_scale(1);
  options.symmetry_axes = {0};
  try {
    DisplacementSpace space(prepared(model), options);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("has no mirror image across the plane x = 0"));
  }
}

TEST(DisplacementSpace, ACollapsedSideIsOneCoefficient) {
  const PatchModel model = prepared(testing::make_sphere(1.0));
  const DisplacementSpace space(model, at_scale(1));
  const Patch& patch = model.patches[0];
  int collapsed = 0;
  const PointClasses classes = point_classes(model);
  for (Side side : kSides) {
    if (!is_collapsed(patch, side, classes)) continue;
    ++collapsed;
    const auto indices = side_indices(patch, side);
    const int c = space.coefficient(0, indices[0].first, indices[0].second);
    for (const auto& [i, j] : indices) EXPECT_EQ(space.coefficient(0, i, j), c);
  }
  EXPECT_EQ(collapsed, 2);
}

}  // namespace
}  // namespace isochor
