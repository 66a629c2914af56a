// Rows keep the skin smooth: displacements that fulfil them, and some that do not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/smooth_relations.h"
#include "support/cut.h"
#include "support/models.h"
#include "support/revolved.h"
#include "support/smooth_rows.h"

namespace isochor {
namespace {

using ::isochor::testing::cut_in_two;
using ::isochor::testing::expect_rows_keep_the_skin;
using ::isochor::testing::finest_knots;

TEST(ContinuityRows, TwoPatchesOfACut) {
  std::mt19937 random(72);
  const KnotVector u = testing::random_clamped(random, 4, 4, 1);
  const KnotVector v = testing::random_clamped(random, 3, 3, 1);
  const PatchModel model =
      cut_in_two(testing::random_surface(random, u, v, false), u.interior()[2]);
  // Two rows of each column across the cut are given up.
  const int free = expect_rows_keep_the_skin(model, finest_knots(model), 0.1);
  const int points = static_cast<int>(model.points.size());
  EXPECT_EQ(free, points - 2 * v.size());
  // Coarser: no interior knots left across.
  std::vector<CoarseKnots> coarse = finest_knots(model);
  for (CoarseKnots& knots : coarse) {
    knots.u = KnotVector(4, [&] {
      std::vector<double> ends(5, knots.u.begin());
      ends.insert(ends.end(), 5, knots.u.end());
      return ends;
    }());
  }
  EXPECT_EQ(expect_rows_keep_the_skin(model, coarse, 0.1), (9 - 2) * v.size());
}

TEST(ContinuityRows, CurvatureWithFactorsOfItsOwn) {
  for (const auto& [lambda, mu] : {std::make_pair(1.5, 0.625), std::make_pair(0.7, -1.1)}) {
    const PatchModel model = testing::curvature_pair(lambda, mu);
    // Four columns of seven points, two of them given up.
    EXPECT_EQ(expect_rows_keep_the_skin(model, finest_knots(model), 0.05), 4 * 5);
  }
}

// Rank over the rationals as the tensor product says: the rows of crossing lines depend on each
// other exactly, whatever rounding did to points and knots.
TEST(ContinuityRows, FourPatchesAtACorner) {
  std::mt19937 random(41);
  const KnotVector u = testing::random_clamped(random, 4, 3, 1);
  const KnotVector v = testing::random_clamped(random, 3, 2, 1);
  PatchModel model = testing::make_separate_model({testing::random_surface(random, u, v, false)});
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  testing::transform(model, turn);
  model = testing::cut_apart(model, {u.interior()[1]}, {v.interior()[0]});
  ASSERT_EQ(model.patches.size(), 4u);
  for (size_t q : {2u, 3u}) testing::stretch(model.patches[q], Direction::kU, 3.0);
  for (size_t q : {1u, 3u}) testing::stretch(model.patches[q], Direction::kV, 0.7);
  model.joins = find_joins(model);
  ASSERT_EQ(model.joins.size(), 4u);
  const auto relations = smooth_relations(model);
  ASSERT_EQ(relations.size(), 4u);
  for (const SmoothRelation& relation : relations) EXPECT_EQ(relation.order, 2);
  // Distinct columns and rows: knots of full multiplicity at the cuts, less two each.
  const int columns = u.size() + 3;
  const int rows = v.size() + 2;
  EXPECT_EQ(expect_rows_keep_the_skin(model, finest_knots(model), 0.1), (columns - 2) * (rows - 2));
}

// Points with nine good digits: the factors of opposite edges are measured differently, and yet no
// row is independent of the others that should not be.
TEST(ContinuityRows, FourPatchesOfNoisyPoints) {
  std::mt19937 random(42);
  const KnotVector u = KnotVector::uniform(4, 3);
  const KnotVector v = KnotVector::uniform(3, 3);
  std::vector<Vec3> poles;
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      poles.emplace_back(u.greville(i), v.greville(j), testing::uniform(random, -0.2, 0.2));
    }
  }
  PatchModel model = testing::cut_apart(testing::make_separate_model({Surface(u, v, poles)}),
                                        {u.interior()[1]}, {v.interior()[0]});
  testing::stretch(model.patches[1], Direction::kV, 0.7);
  testing::stretch(model.patches[3], Direction::kV, 0.7);
  for (Vec3& p : model.points) {
    p += 1e-9 * Vec3(testing::uniform(random, -1, 1), testing::uniform(random, -1, 1),
                     testing::uniform(random, -1, 1));
  }
  model.joins = find_joins(model);
  const auto relations = smooth_relations(model);
  ASSERT_EQ(relations.size(), 4u);
  double worst = 0.0;
  for (const SmoothRelation& relation : relations) worst = std::max(worst, relation.residual);
  EXPECT_GT(worst, 1e-10);
  EXPECT_LT(worst, 1e-7);
  const ContinuityRows rows = continuity_rows(model, relations, finest_knots(model));
  const testing::CoarseSpace space(model, finest_knots(model));
  const int free = (u.size() + 3 - 2) * (v.size() + 2 - 2);
  EXPECT_EQ(testing::freedom(space, rows.rows), free);
  const auto moved = space.moved(
      space.random_solution(testing::joined(space.ties(), space.rows_of(rows.rows)), 0.05));
  EXPECT_LT(testing::seams_of(model, moved).angle, 1e-7);
}

TEST(ContinuityRows, RationalTorus) {
  for (bool four : {false, true}) {
    PatchModel model = testing::make_rational_torus(2.0, 0.5);
    model.joins = find_joins(model);
    if (four) model = testing::cut_apart(model, {1.0, 2.0, 3.0}, {2.0});
    SCOPED_TRACE(model.patches.size());
    // 8 x 8 poles, 4 x 4 free: each circle of eight poles gives up one for each of its four lines.
    EXPECT_EQ(expect_rows_keep_the_skin(model, finest_knots(model), 0.05), 16);
  }
}

// A column of a cylinder of nine poles: four of eight are free.
TEST(ContinuityRows, RationalCylinder) {
  for (testing::Circle circle :
       {testing::Circle::kQuadratic, testing::Circle::kCubic, testing::Circle::kPeriodic}) {
    PatchModel model =
        testing::make_revolved(KnotVector::uniform(1, 1), {{1.0, 0.0}, {1.0, 3.0}}, {}, circle);
    model.joins = find_joins(model);
    EXPECT_EQ(expect_rows_keep_the_skin(model, finest_knots(model), 0.1), 2 * 4);
  }
}

// A pole has its point and two directions; the cylinder's two rings behind it four each, of which
// the knot line takes one ring.
TEST(ContinuityRows, NosesWithATangentPlane) {
  for (testing::Circle circle :
       {testing::Circle::kQuadratic, testing::Circle::kCubic, testing::Circle::kPeriodic}) {
    SCOPED_TRACE(static_cast<int>(circle));
    PatchModel model = testing::make_nose(1.0, 4.0, circle);
    model.joins = find_joins(model);
    EXPECT_EQ(expect_rows_keep_the_skin(model, finest_knots(model), 0.05), 3 + 3 * 4 - 4);
  }
}

TEST(ContinuityRows, PolesClosedByOnePatchAndByFour) {
  PatchModel sphere = testing::make_sphere(1.0);
  sphere.joins = find_joins(sphere);
  // Two poles with their planes; the equator lies between their rings.
  EXPECT_EQ(expect_rows_keep_the_skin(sphere, finest_knots(sphere), 0.05), 6);
  const PatchModel four = testing::cut_apart(sphere, {1.0, 2.0, 3.0}, {});
  ASSERT_EQ(four.patches.size(), 4u);
  EXPECT_EQ(expect_rows_keep_the_skin(four, finest_knots(four), 0.05), 6);
}

// Linear maps of the model fulfil the rows to rounding.
TEST(ContinuityRows, LinearMapsFulfilTheRows) {
  for (PatchModel model : {testing::make_sphere(1.0), testing::make_rational_torus(2.0, 0.5),
                           testing::make_nose(1.0, 4.0, testing::Circle::kCubic)}) {
    model.joins = find_joins(model);
    Eigen::Matrix3d matrix;
    matrix << 1.0, 0.3, -0.2, 0.1, 0.8, 0.5, -0.4, 0.2, 1.1;
    const auto rows = continuity_rows(model, smooth_relations(model), finest_knots(model)).rows;
    for (const ContinuityRow& row : rows) {
      Vec3 sum = Vec3::Zero();
      double size = 0.0;
      for (const GridTerm& term : row.terms) {
        const Patch& patch = model.patches[static_cast<size_t>(term.patch)];
        const double value = term.value.to_double();
        sum += value * (matrix * model.points[static_cast<size_t>(patch.point(term.i, term.j))]);
        size += std::abs(value);
      }
      EXPECT_LT(sum.norm(), 1e-13 * size);
    }
  }
}

}  // namespace
}  // namespace isochor
