// Rows on coarse coefficients: one for each coarse function along the line, however fine the grid.
#include <gtest/gtest.h>

#include <cmath>

#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/model_refinement.h"
#include "isochor/bspline/refinement.h"
#include "isochor/bspline/smooth_relations.h"
#include "support/cut.h"
#include "support/models.h"
#include "support/revolved.h"
#include "support/smooth_rows.h"

namespace isochor {
namespace {

using ::isochor::testing::CoarseSpace;
using ::isochor::testing::cut_in_two;
using ::isochor::testing::expect_rows_keep_the_skin;
using ::isochor::testing::finest_knots;
using ::isochor::testing::freedom;

// The model on finer knots, its own knots as the coarse ones.
struct TwoGrids {
  PatchModel fine;
  std::vector<CoarseKnots> coarse;
};

TwoGrids refined_under(const PatchModel& model, int u_spans, int v_spans) {
  TwoGrids grids{model, finest_knots(model)};
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const Patch& patch = grids.fine.patches[static_cast<size_t>(q)];
    grids.fine = refine(grids.fine, q, refined_to_spans(patch.u_knots, u_spans),
                        refined_to_spans(patch.v_knots, v_spans));
  }
  grids.fine = without_unused_points(grids.fine);
  grids.fine.joins = find_joins(grids.fine);
  return grids;
}

TEST(ContinuityRowsCoarse, FreedomIsThatOfTheCoarseGrid) {
  std::mt19937 random(51);
  const KnotVector u = testing::random_clamped(random, 3, 3, 1);
  const KnotVector v = testing::random_clamped(random, 3, 2, 1);
  const PatchModel model =
      cut_in_two(testing::random_surface(random, u, v, false), u.interior()[1]);
  const TwoGrids grids = refined_under(model, 6, 5);
  ASSERT_GT(grids.fine.points.size(), model.points.size());
  const int free = expect_rows_keep_the_skin(grids.fine, grids.coarse, 0.1);
  EXPECT_EQ(free, static_cast<int>(model.points.size()) - 2 * v.size());
  const auto relations = smooth_relations(grids.fine);
  EXPECT_EQ(continuity_rows(grids.fine, relations, grids.coarse).rows.size(),
            2u * static_cast<size_t>(v.size()));
}

// Removing a whole knot line from the coarse grid removes its rows.
TEST(ContinuityRowsCoarse, LinesThatTheScaleSmoothsNeedNoRows) {
  std::mt19937 random(52);
  const KnotVector smooth = KnotVector::uniform(3, 4);
  const Surface surface = testing::random_surface(random, smooth, smooth, false);
  const Surface rough = refine(surface, with_knots(smooth, {0.5, 0.5}), smooth);
  PatchModel model = testing::make_separate_model({rough});
  const auto relations = smooth_relations(model);
  ASSERT_EQ(relations.size(), 1u);
  EXPECT_EQ(relations[0].order, 2);
  const int rows =
      static_cast<int>(continuity_rows(model, relations, finest_knots(model)).rows.size());
  EXPECT_EQ(rows, 2 * smooth.size());
  std::vector<CoarseKnots> coarse = {{KnotVector::clamped(3, {0.0, 0.25, 0.75, 1.0}), smooth}};
  EXPECT_EQ(continuity_rows(model, relations, coarse).rows.size(), 0u);
  coarse[0].u = smooth;  // a simple knot of a cubic: the same
  EXPECT_EQ(continuity_rows(model, relations, coarse).rows.size(), 0u);
  EXPECT_EQ(expect_rows_keep_the_skin(model, coarse, 0.1), smooth.size() * smooth.size());
}

TEST(ContinuityRowsCoarse, RationalCylinderUnderAFinerGrid) {
  for (testing::Circle circle :
       {testing::Circle::kQuadratic, testing::Circle::kCubic, testing::Circle::kPeriodic}) {
    SCOPED_TRACE(static_cast<int>(circle));
    PatchModel model =
        testing::make_revolved(KnotVector::uniform(1, 1), {{1.0, 0.0}, {1.0, 3.0}}, {}, circle);
    model.joins = find_joins(model);
    const TwoGrids grids = refined_under(model, 12, 4);
    EXPECT_EQ(expect_rows_keep_the_skin(grids.fine, grids.coarse, 0.1), 2 * 4);
  }
}

// The fine second row of a rational nose is no spline on the coarse circle: around the pole only
// shifts are at hand. Coarsened along the meridians only, all affine maps are.
TEST(ContinuityRowsCoarse, RationalNoseUnderAFinerGrid) {
  PatchModel model = testing::make_nose(1.0, 4.0);
  model.joins = find_joins(model);
  TwoGrids grids = refined_under(model, 8, 4);
  EXPECT_EQ(expect_rows_keep_the_skin(grids.fine, grids.coarse, 0.05), 1 + 3 * 4 - 4);
  grids.coarse[0].u = grids.fine.patches[0].u_knots;
  // A circle of eight spans: 12 poles, four lines of multiplicity two.
  EXPECT_EQ(expect_rows_keep_the_skin(grids.fine, grids.coarse, 0.05), 3 + 3 * 8 - 8);
}

// A nose of cubics around a smooth periodic direction: u wraps, v0 is a pole in the plane z = 0.
PatchModel make_spline_nose(int around) {
  PatchModel model;
  std::vector<double> knots;
  for (int k = -3; k <= around + 3; ++k) knots.push_back(k);
  Patch patch{"nose", "face:1", KnotVector(3, knots), KnotVector::uniform(3, 2), {}, {}, false,
              {},     {}};
  const int rows = patch.v_size();
  const double turn = 2.0 * std::acos(-1.0) / around;
  for (int i = 0; i < around; ++i) {
    for (int j = 1; j < rows; ++j) {
      const double r = j == 1 ? 0.6 : 1.0 + 0.1 * j;
      model.points.emplace_back(r * std::cos(turn * i), 0.8 * r * std::sin(turn * i + 0.1),
                                0.5 * (j - 1) * (j - 1));
    }
  }
  model.points.emplace_back(0.1, 0.0, 0.0);
  for (int i = 0; i < around + 3; ++i) {
    patch.points.push_back(static_cast<int>(model.points.size()) - 1);
    for (int j = 1; j < rows; ++j) patch.points.push_back(i % around * (rows - 1) + j - 1);
  }
  model.patches.push_back(patch);
  model.joins = find_joins(model);
  return model;
}

TEST(ContinuityRowsCoarse, SplineNoseUnderAFinerGrid) {
  const PatchModel model = make_spline_nose(6);
  EXPECT_EQ(expect_rows_keep_the_skin(model, finest_knots(model), 0.05), 3 + 3 * 6);
  TwoGrids grids{model, finest_knots(model)};
  const Patch& patch = model.patches[0];
  grids.fine = without_unused_points(
      refine(model, 0, wrapped_with_knots(patch.u_knots, {0.5, 1.5, 2.5, 3.5, 4.5, 5.5}),
             with_knots(patch.v_knots, {0.1, 0.2, 0.7})));
  grids.fine.joins = find_joins(grids.fine);
  EXPECT_EQ(grids.fine.patches[0].u_size(), 15);
  EXPECT_EQ(expect_rows_keep_the_skin(grids.fine, grids.coarse, 0.05), 3 + 3 * 6);
}

// Weights that do not separate: rows for each pole along the line, as long as that is not coarser.
TEST(ContinuityRowsCoarse, WeightsThatDoNotSeparate) {
  std::mt19937 random(53);
  const KnotVector u = testing::random_clamped(random, 4, 3, 1);
  const KnotVector v = testing::random_clamped(random, 3, 2, 1);
  // Not too wild, so that curvatures can be measured.
  std::vector<Vec3> poles;
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      poles.emplace_back(u.greville(i), v.greville(j), testing::uniform(random, -0.2, 0.2));
    }
  }
  const auto weights = testing::random_surface(random, u, v, true).weights();
  const PatchModel model = cut_in_two(Surface(u, v, poles, weights), u.interior()[1]);
  const auto relations = smooth_relations(model);
  ASSERT_EQ(relations.size(), 1u);
  EXPECT_EQ(relations[0].equations[0].size(), static_cast<size_t>(v.size()));
  EXPECT_EQ(expect_rows_keep_the_skin(model, finest_knots(model), 0.01),
            static_cast<int>(model.points.size()) - 2 * v.size());
  std::vector<CoarseKnots> coarse = finest_knots(model);
  for (CoarseKnots& knots : coarse) knots.v = KnotVector::clamped(3, {v.begin(), v.end()});
  const ContinuityRows rows = continuity_rows(model, relations, coarse);
  EXPECT_TRUE(rows.rows.empty());
  EXPECT_EQ(rows.inexpressible, std::vector<int>{0});
}

// The two sides of a join at different scales along it: nothing can be stated.
TEST(ContinuityRowsCoarse, ScalesThatDisagreeAlongAJoin) {
  std::mt19937 random(54);
  const KnotVector u = testing::random_clamped(random, 4, 3, 1);
  const KnotVector v = testing::random_clamped(random, 3, 2, 1);
  const PatchModel model =
      cut_in_two(testing::random_surface(random, u, v, false), u.interior()[1]);
  std::vector<CoarseKnots> coarse = finest_knots(model);
  coarse[1].v = KnotVector::clamped(3, {v.begin(), v.end()});
  const auto relations = smooth_relations(model);
  EXPECT_EQ(continuity_rows(model, relations, coarse).inexpressible, std::vector<int>{0});
  coarse.pop_back();
  EXPECT_THROW(continuity_rows(model, relations, coarse), PreconditionError);
}

}  // namespace
}  // namespace isochor
