#include "isochor/bspline/model_refinement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "isochor/base/error.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/refinement.h"
#include "support/messages.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::message_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

void expect_same_shape(const PatchModel& a, const PatchModel& b, double bound) {
  ASSERT_EQ(a.patches.size(), b.patches.size());
  for (int q = 0; q < static_cast<int>(a.patches.size()); ++q) {
    const Surface sa = a.surface(q);
    const Surface sb = b.surface(q);
    for (double u : testing::sample_parameters(sb.u_knots(), 1)) {
      for (double v : testing::sample_parameters(sb.v_knots(), 1)) {
        EXPECT_LT((sa.point(u, v) - sb.point(u, v)).norm(), bound) << q;
      }
    }
  }
}

void expect_joins_kept(const PatchModel& before, const PatchModel& after) {
  const auto old_joins = find_joins(before);
  const auto new_joins = find_joins(after);
  ASSERT_EQ(old_joins.size(), new_joins.size());
  for (size_t i = 0; i < old_joins.size(); ++i) {
    EXPECT_EQ(new_joins[i].matching, old_joins[i].matching) << new_joins[i].mismatch;
    EXPECT_EQ(new_joins[i].smoothness, old_joins[i].smoothness);
  }
  EXPECT_EQ(closure(before).closed, closure(after).closed);
}

size_t used_classes(const PatchModel& model) {
  const PointClasses classes = point_classes(model);
  std::set<int> used;
  for (const Patch& patch : model.patches) {
    for (int id : patch.points) used.insert(classes.class_of[static_cast<size_t>(id)]);
  }
  return used.size();
}

// The same model with the points of every patch separate, tied where they were shared.
PatchModel with_ties(const PatchModel& model) {
  PatchModel tied = model;
  tied.points.clear();
  std::vector<int> first(model.points.size(), -1);
  for (Patch& patch : tied.patches) {
    for (int& id : patch.points) {
      const auto old = static_cast<size_t>(id);
      id = static_cast<int>(tied.points.size());
      tied.points.push_back(model.points[old]);
      if (first[old] < 0) {
        first[old] = id;
      } else {
        tied.ties.emplace_back(first[old], id);
      }
    }
  }
  return tied;
}

PatchModel with_joins(PatchModel model) {
  model.joins = find_joins(model);
  return model;
}

KnotVector with_one(const KnotVector& knots, double share) {
  return with_knots(knots, {knots.begin() + share * (knots.end() - knots.begin())});
}

TEST(ModelRefinement, ClosedModelsStayClosedWhicheverPatchIsRefined) {
  for (double weight_ratio : {1.0, 3.0}) {
    testing::RandomModelOptions options;
    options.degrees[1] = 2;
    options.weight_ratio = weight_ratio;
    for (const bool ties : {false, true}) {
      PatchModel model = testing::random_closed_model(5, options);
      if (ties) model = with_ties(model);
      model = with_joins(model);
      derive_locks(model, {});
      for (int q : {0, 2, 5}) {
        const Patch& patch = model.patches[static_cast<size_t>(q)];
        const PatchModel fine =
            refine(model, q, with_one(patch.u_knots, 0.31), with_one(patch.v_knots, 0.77));
        expect_same_shape(model, fine, 1e-13);
        expect_joins_kept(model, fine);
        EXPECT_THAT(fine.locks, IsEmpty());
        for (const Join& join : fine.joins) EXPECT_TRUE(join.matching) << join.mismatch;
        // Four patches around gain a row in u, four in v: exactly one new class per cut pole.
        // A box with pole counts a, b, c along its axes has these many distinct points.
        const auto count = [](int a, int b, int c) {
          return static_cast<size_t>(a * b * c - (a - 2) * (b - 2) * (c - 2));
        };
        std::vector<int> sizes = {model.patches[0].u_size(), model.patches[0].v_size(),
                                  model.patches[2].v_size()};
        ASSERT_EQ(used_classes(model), count(sizes[0], sizes[1], sizes[2]));
        sizes = {fine.patches[0].u_size(), fine.patches[0].v_size(), fine.patches[2].v_size()};
        EXPECT_EQ(used_classes(fine), count(sizes[0], sizes[1], sizes[2]));
      }
    }
  }
}

TEST(ModelRefinement, UntouchedPolesKeepPointAndBits) {
  const PatchModel model = with_joins(testing::make_cube_model(3, 10));
  const Patch& top = model.patches[0];
  const PatchModel fine = refine(model, 0, with_one(top.u_knots, 0.05), top.v_knots);
  ASSERT_GE(fine.points.size(), model.points.size());
  EXPECT_EQ(
      std::memcmp(fine.points.data(), model.points.data(), model.points.size() * sizeof(Vec3)), 0);
  // x runs along u of top; poles whose functions end before or start after the cut span stay.
  for (int j = 0; j < top.v_size(); ++j) {
    EXPECT_EQ(fine.patches[0].point(0, j), top.point(0, j));
    EXPECT_EQ(fine.patches[0].point(9, j), top.point(8, j));
  }
  // "right" and "left" (x = const) do not run along x: not changed at all.
  for (size_t q : {2u, 3u}) {
    EXPECT_EQ(fine.patches[q].points, model.patches[q].points);
    EXPECT_EQ(fine.patches[q].u_knots, model.patches[q].u_knots);
  }
}

TEST(ModelRefinement, SeamsAndPolesOfASphere) {
  const PatchModel model = with_joins(testing::make_sphere(2.0));
  const Patch& patch = model.patches[0];
  const PatchModel fine =
      refine(model, 0, refined_to_spans(patch.u_knots, 12), refined_to_spans(patch.v_knots, 6));
  expect_same_shape(model, fine, 1e-13);
  expect_joins_kept(model, fine);
  const PointClasses classes = point_classes(fine);
  int collapsed = 0;
  for (Side side : kSides) collapsed += is_collapsed(fine.patches[0], side, classes);
  EXPECT_EQ(collapsed, 2);
  for (const Vec3& p : fine.points) EXPECT_TRUE(p.allFinite());
}

TEST(ModelRefinement, WrapsOfATorus) {
  for (const bool ties : {false, true}) {
    PatchModel model = testing::make_periodic_torus(3, 2, 7, 8);
    if (ties) model = with_ties(model);
    model = with_joins(model);
    const Patch& patch = model.patches[0];
    // Close to the ends, where the wrap matters.
    const PatchModel fine =
        refine(model, 0, with_one(patch.u_knots, 0.02), with_one(patch.v_knots, 0.97));
    expect_same_shape(model, fine, 1e-13);
    expect_joins_kept(model, fine);
    const PointClasses classes = point_classes(fine);
    EXPECT_EQ(wrapped_rows(fine.patches[0], Direction::kU, classes), 3);
    EXPECT_EQ(wrapped_rows(fine.patches[0], Direction::kV, classes), 2);
    EXPECT_EQ(used_classes(fine), 8u * 9u);
  }
}

TEST(ModelRefinement, OpposedJoinsReverseTheKnots) {
  // Two strips that share a side, the second one running the other way over another domain.
  const KnotVector u = KnotVector::uniform(2, 1);
  PatchModel model;
  for (int k = 0; k < 25; ++k) model.points.emplace_back(k / 5, k % 5, (k % 3) * 0.1);
  const KnotVector along = KnotVector::clamped(3, {0, 0.25, 1});
  const KnotVector against = KnotVector::clamped(3, {10, 13, 14});
  Patch first{"", "face:1", u, along, {}, {}, false, {}, {}};
  Patch second{"", "face:2", u, against, {}, {}, false, {}, {}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 5; ++j) {
      first.points.push_back(5 * i + j);
      second.points.push_back(5 * (i + 2) + 4 - j);
    }
  }
  model.patches = {first, second};
  model = with_joins(model);
  ASSERT_EQ(model.joins.size(), 1u);
  ASSERT_TRUE(model.joins[0].opposed && model.joins[0].matching) << model.joins[0].mismatch;
  const PatchModel fine = refine(model, 0, u, with_knots(along, {0.25, 0.5}));
  expect_same_shape(model, fine, 1e-13);
  expect_joins_kept(model, fine);
  EXPECT_EQ(fine.patches[1].v_knots.interior(), (std::vector<double>{12, 13, 13}));
}

TEST(ModelRefinement, NeighboursThatDoNotMatchAreLeftAlone) {
  const KnotVector knots = KnotVector::uniform(3, 3);
  std::mt19937 random(81);
  const Surface surface = testing::random_surface(random, knots, knots, false);
  const Surface other = refine(surface, knots, refined_to_spans(knots, 4));
  PatchModel model = testing::make_separate_model({surface, other});
  model.joins = {measure_join(model, {0, Side::kUEnd}, {1, Side::kUEnd}, false)};
  ASSERT_FALSE(model.joins[0].matching);
  const PatchModel fine = refine(model, 0, knots, with_knots(knots, {0.9}));
  EXPECT_EQ(fine.patches[1].v_knots, model.patches[1].v_knots);
  EXPECT_THAT(fine.joins[0].mismatch, HasSubstr("7 poles against 9"));
}

TEST(ModelRefinement, UnusedPointsCanBeDropped) {
  PatchModel model = with_joins(with_ties(testing::make_cube_model(3, 4)));
  const Patch& top = model.patches[0];
  PatchModel fine = refine(model, 0, refined_to_spans(top.u_knots, 8), top.v_knots);
  derive_locks(fine, {});
  const PatchModel compact = without_unused_points(fine);
  EXPECT_LT(compact.points.size(), fine.points.size());
  size_t corners = 0;
  for (const Patch& patch : compact.patches) corners += patch.points.size();
  EXPECT_EQ(compact.points.size(), corners);
  EXPECT_EQ(used_classes(compact), used_classes(fine));
  expect_same_shape(fine, compact, 1e-300);
  validate(compact);
}

TEST(ModelRefinement, ErrorsNameThePatch) {
  PatchModel model = with_joins(testing::make_cube_model(2, 3));
  model.patches[0].name = "top";
  const KnotVector& u = model.patches[0].u_knots;
  const KnotVector& v = model.patches[0].v_knots;
  EXPECT_THROW(refine(model, 9, u, v), PreconditionError);
  EXPECT_THROW(refine(model, 0, KnotVector::uniform(2, 2), v), PreconditionError);
  // A knot of the neighbour cannot be raised further: the chain reaches "front" and names it.
  PatchModel uneven = model;
  const KnotVector twice = with_knots(u, {u.interior()[0]});
  EXPECT_NO_THROW(refine(uneven, 0, twice, v));
  uneven.joins[0].matching = true;
  for (Patch& patch : uneven.patches) {
    if (&patch == &uneven.patches[0]) continue;
    // Pretend that the others carry the knot twice already.
    const auto raise = [](const KnotVector& knots) {
      return with_knots(knots, {knots.interior()[0]});
    };
    patch.u_knots = raise(patch.u_knots);
    patch.v_knots = raise(patch.v_knots);
    patch.points.assign(static_cast<size_t>(patch.u_size() * patch.v_size()), 0);
  }
  const std::string reason = message_of<InputError>([&] { (void)refine(uneven, 0, twice, v); });
  EXPECT_THAT(reason, HasSubstr("refine face:"));
  EXPECT_THAT(reason, HasSubstr("has multiplicity 3"));
}

}  // namespace
}  // namespace isochor
