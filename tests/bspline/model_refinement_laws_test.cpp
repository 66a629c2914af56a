// Refinement of models that carry everything a model can carry, again and again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/model_refinement.h"
#include "isochor/bspline/refinement.h"
#include "support/models.h"
#include "support/revolved.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::testing::IsEmpty;

KnotVector with_share(const KnotVector& knots, double share) {
  return with_knots(knots, {knots.begin() + share * (knots.end() - knots.begin())});
}

double largest_distance(const PatchModel& a, const PatchModel& b) {
  double largest = 0.0;
  for (int q = 0; q < static_cast<int>(a.patches.size()); ++q) {
    const Surface sa = a.surface(q);
    const Surface sb = b.surface(q);
    for (double u : testing::sample_parameters(sb.u_knots(), 1)) {
      for (double v : testing::sample_parameters(sb.v_knots(), 1)) {
        largest = std::max(largest, (sa.point(u, v) - sb.point(u, v)).norm());
      }
    }
  }
  return largest;
}

// Everything that refinement has to leave alone.
void expect_carried_over(const PatchModel& before, const PatchModel& after) {
  EXPECT_EQ(after.unit, before.unit);
  EXPECT_EQ(after.fixed_points, before.fixed_points);
  ASSERT_EQ(after.locked_sides.size(), before.locked_sides.size());
  for (size_t k = 0; k < before.locked_sides.size(); ++k) {
    EXPECT_EQ(after.locked_sides[k].side, before.locked_sides[k].side);
    EXPECT_EQ(after.locked_sides[k].reason, before.locked_sides[k].reason);
    EXPECT_EQ(after.locked_sides[k].smoothness, before.locked_sides[k].smoothness);
  }
  for (size_t q = 0; q < before.patches.size(); ++q) {
    EXPECT_EQ(after.patches[q].name, before.patches[q].name);
    EXPECT_EQ(after.patches[q].handle, before.patches[q].handle);
    EXPECT_EQ(after.patches[q].aliases, before.patches[q].aliases);
    EXPECT_EQ(after.patches[q].reversed, before.patches[q].reversed);
    EXPECT_EQ(after.patches[q].trim.loops, before.patches[q].trim.loops);
    EXPECT_EQ(after.patches[q].trim.boundary.size(), before.patches[q].trim.boundary.size());
  }
  for (size_t i = 0; i < before.points.size(); ++i) EXPECT_EQ(after.points[i], before.points[i]);
}

TEST(ModelRefinementLaws, ManyRefinementsInARow) {
  std::mt19937 random(371);
  testing::RandomModelOptions options;
  options.degrees[0] = 2;
  options.degrees[2] = 4;
  options.spans = 2;
  for (double ratio : {1.0, 5.0}) {
    options.weight_ratio = ratio;
    PatchModel model = testing::random_closed_model(372, options);
    model.unit = "mm";
    model.patches[1].aliases = {"#17"};
    model.patches[2].trim.loops = {{{0.1, 0.1}, {0.9, 0.1}, {0.5, 0.8}}};
    model.locked_sides = {{{4, Side::kUEnd}, "is welded", Smoothness::kTangent}};
    model.fixed_points = {{0, "a corner"}};
    model.joins = find_joins(model);
    const PatchModel first = model;
    for (int step = 0; step < 6; ++step) {
      const int q = std::uniform_int_distribution<int>(0, 5)(random);
      const Patch& patch = model.patches[static_cast<size_t>(q)];
      PatchModel fine = refine(model, q, with_share(patch.u_knots, testing::uniform(random, 0, 1)),
                               with_share(patch.v_knots, testing::uniform(random, 0, 1)));
      expect_carried_over(model, fine);
      for (const Join& join : fine.joins) {
        EXPECT_TRUE(join.matching) << join.mismatch;
        EXPECT_LT(join_gap(fine, fine.points, join), 1e-14);
      }
      EXPECT_TRUE(closure(fine).closed);
      model = std::move(fine);
    }
    EXPECT_LT(largest_distance(first, model), 1e-13);
    const PatchModel compact = without_unused_points(model);
    validate(compact);
    EXPECT_LT(compact.points.size(), model.points.size());
    EXPECT_EQ(largest_distance(model, compact), 0.0);
    EXPECT_EQ(find_joins(compact).size(), 12u);
  }
}

TEST(ModelRefinementLaws, RefiningToWhatIsThereChangesNothing) {
  PatchModel model = testing::random_closed_model(373);
  model.joins = find_joins(model);
  const PatchModel same = refine(model, 3, model.patches[3].u_knots, model.patches[3].v_knots);
  EXPECT_EQ(same.points, model.points);
  EXPECT_THAT(same.ties, IsEmpty());
  for (size_t q = 0; q < model.patches.size(); ++q) {
    EXPECT_EQ(same.patches[q].points, model.patches[q].points);
    EXPECT_EQ(same.patches[q].u_knots, model.patches[q].u_knots);
  }
  EXPECT_EQ(refine(model, std::vector<PatchKnots>{}).points, model.points);
}

TEST(ModelRefinementLaws, WishesForOnePatchAndItsNeighbourAreMerged) {
  PatchModel model = testing::make_cube_model(3, 2);
  model.joins = find_joins(model);
  // The same knot asked for from both sides of an edge counts once; two different ones twice.
  const Patch& top = model.patches[0];     // (x, y)
  const Patch& bottom = model.patches[1];  // (y, x)
  const PatchModel once = refine(model, {{0, with_share(top.u_knots, 0.25), top.v_knots},
                                         {1, bottom.u_knots, with_share(bottom.v_knots, 0.25)}});
  EXPECT_EQ(once.patches[0].u_size(), top.u_size() + 1);
  EXPECT_EQ(once.patches[1].v_size(), bottom.v_size() + 1);
  const PatchModel twice = refine(model, {{0, with_share(top.u_knots, 0.25), top.v_knots},
                                          {1, bottom.u_knots, with_share(bottom.v_knots, 0.75)},
                                          {0, with_share(top.u_knots, 0.25), top.v_knots}});
  EXPECT_EQ(twice.patches[0].u_size(), top.u_size() + 2);
  EXPECT_EQ(twice.patches[4].v_size(), model.patches[4].v_size() + 2);
  EXPECT_TRUE(closure(twice).closed);
}

// A square whose sides u0 and v0 are glued to each other: what is inserted in u comes back in v.
TEST(ModelRefinementLaws, APatchMayBeItsOwnNeighbourAcrossDirections) {
  const KnotVector knots = KnotVector::uniform(2, 1);
  PatchModel model;
  Patch patch{"", "face:1", knots, knots, {}, {}, false, {}, {}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i > 0 && j == 0) {
        patch.points.push_back(patch.points[static_cast<size_t>(i)]);
        continue;
      }
      patch.points.push_back(static_cast<int>(model.points.size()));
      model.points.emplace_back(j - i, i + j, (i * j) % 3);
    }
  }
  model.patches.push_back(patch);
  model.joins = find_joins(model);
  ASSERT_EQ(model.joins.size(), 1u);
  ASSERT_TRUE(model.joins[0].matching) << model.joins[0].mismatch;
  const PatchModel fine = refine(model, 0, with_knots(knots, {0.25, 0.5}), with_share(knots, 0.5));
  EXPECT_EQ(fine.patches[0].u_knots.interior(), (std::vector<double>{0.25, 0.5}));
  EXPECT_EQ(fine.patches[0].v_knots, fine.patches[0].u_knots);
  EXPECT_LT(largest_distance(model, fine), 1e-14);
  EXPECT_TRUE(find_joins(fine)[0].matching);
  for (int k = 0; k < fine.patches[0].u_size(); ++k) {
    EXPECT_EQ(fine.patches[0].point(k, 0), fine.patches[0].point(0, k));
  }
}

TEST(ModelRefinementLaws, RevolvedModelsKeepSeamsPolesAndClosedProfiles) {
  const KnotVector profile = KnotVector::clamped(1, {0, 1, 2});
  for (PatchModel model : {testing::make_rational_torus(3.0, 1.0),
                           testing::make_revolved(profile, {{0, 0}, {2, 0}, {0, 3}})}) {
    model.joins = find_joins(model);
    const bool closed = closure(model).closed;
    EXPECT_TRUE(closed);
    const Patch& patch = model.patches[0];
    const PatchModel fine =
        refine(model, 0, refined_to_spans(patch.u_knots, 9), refined_to_spans(patch.v_knots, 5));
    EXPECT_LT(largest_distance(model, fine), 1e-14);
    EXPECT_TRUE(closure(fine).closed);
    ASSERT_EQ(fine.joins.size(), model.joins.size());
    for (const Join& join : fine.joins) EXPECT_TRUE(join.matching) << join.mismatch;
    const PointClasses before = point_classes(model);
    const PointClasses after = point_classes(fine);
    for (Side side : kSides) {
      EXPECT_EQ(is_collapsed(fine.patches[0], side, after),
                is_collapsed(model.patches[0], side, before));
    }
  }
}

TEST(ModelRefinementLaws, DroppedPointsTakeTheirLocksWithThem) {
  PatchModel model = testing::make_cube_model(1, 1);
  model.points.insert(model.points.begin() + 3, Vec3(9, 9, 9));
  for (Patch& patch : model.patches) {
    for (int& id : patch.points) id += id >= 3 ? 1 : 0;
  }
  // Point 3 belongs to nobody, yet two ties meet in it.
  model.ties = {{2, 3}, {3, 5}};
  model.fixed_points = {{3, "nobody's"}, {8, "a corner"}};
  model.lock(3, "nobody's", false);
  model.lock(7, "held", false);
  const PatchModel compact = without_unused_points(model);
  ASSERT_EQ(compact.points.size(), 8u);
  EXPECT_EQ(compact.ties, (std::vector<std::pair<int, int>>{{2, 4}}));
  EXPECT_EQ(compact.fixed_points, (std::vector<std::pair<int, std::string>>{{7, "a corner"}}));
  ASSERT_EQ(compact.locks.size(), 1u);
  EXPECT_EQ(compact.locks[0].point, 6);
  EXPECT_EQ(compact.lock_reasons[static_cast<size_t>(compact.locks[0].reason)].text, "held");
  validate(compact);
  EXPECT_EQ(largest_distance(model, compact), 0.0);
}

// Law (3) of continuity.h after refinement: more freedom, never less, and the same promises.
TEST(ModelRefinementLaws, LocksAreDerivedAfresh) {
  PatchModel model = testing::make_sphere(1.0);
  model.joins = find_joins(model);
  derive_locks(model, {});
  const auto free_share = [](const PatchModel& of) {
    std::set<int> locked;
    for (const Lock& lock : of.locks) locked.insert(lock.point);
    std::set<int> used(of.patches[0].points.begin(), of.patches[0].points.end());
    size_t free = 0;
    for (int id : used) free += locked.count(id) == 0;
    return static_cast<double>(free) / static_cast<double>(used.size());
  };
  EXPECT_EQ(free_share(model), 0.0);
  const Patch& patch = model.patches[0];
  PatchModel fine =
      refine(model, 0, refined_to_spans(patch.u_knots, 24), refined_to_spans(patch.v_knots, 12));
  EXPECT_THAT(fine.locks, IsEmpty());
  EXPECT_THAT(fine.lock_reasons, IsEmpty());
  derive_locks(fine, {});
  EXPECT_GT(free_share(fine), 0.3);
}

}  // namespace
}  // namespace isochor
