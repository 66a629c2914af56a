#include "isochor/bspline/smooth_relations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "support/cut.h"
#include "support/locks.h"
#include "support/models.h"
#include "support/revolved.h"
#include "support/splines.h"

namespace isochor {
namespace {

using Kind = SmoothRelation::Kind;
using ::isochor::testing::cut_in_two;
using ::isochor::testing::locked_points;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Rational ratio(long numerator, long denominator) {
  return Rational(Integer(numerator), Integer(denominator));
}

TEST(SmoothRelations, FactorsOfACutAreMeasuredRight) {
  std::mt19937 random(72);
  for (bool rational : {false, true}) {
    const KnotVector u = testing::random_clamped(random, 4, 5, 1);
    const KnotVector v = testing::random_clamped(random, 3, 3, 1);
    Surface surface = testing::random_surface(random, u, v, false);
    if (rational) {  // weights that separate
      std::vector<double> weights;
      for (int i = 0; i < u.size(); ++i) {
        for (int j = 0; j < v.size(); ++j) weights.push_back((1.0 + i % 3) * (2.0 + j % 2));
      }
      surface = Surface(u, v, surface.poles(), weights);
    }
    PatchModel model = cut_in_two(surface, u.interior()[2]);
    testing::stretch(model.patches[1], Direction::kU, 4.0);
    const auto relations = smooth_relations(model);
    ASSERT_EQ(relations.size(), 1u);
    EXPECT_EQ(relations[0].kind, Kind::kJoin);
    EXPECT_EQ(relations[0].join, 0);
    EXPECT_EQ(relations[0].order, 2);
    EXPECT_EQ(relations[0].lambda, ratio(1, 4));
    EXPECT_EQ(relations[0].mu, Rational(0));
    EXPECT_LT(relations[0].residual, 1e-13);
    EXPECT_EQ(relations[0].text, "face:1 (\"fore\") and face:2 (\"aft\") meet smoothly (G2)");
    ASSERT_EQ(relations[0].equations.size(), 2u);
    for (const auto& equations : relations[0].equations) {
      ASSERT_EQ(equations.size(), 1u);
      Rational sum;
      for (const LineTerm& term : equations[0]) sum += term.value;
      EXPECT_EQ(sum, Rational(0)) << "translations, exactly";
    }
    EXPECT_EQ(relations[0].equations[0][0].size(), 3u);
    EXPECT_EQ(relations[0].equations[1][0].size(), 5u);
  }
}

TEST(SmoothRelations, FactorsOfCurvatureAreMeasuredRight) {
  const PatchModel model = testing::curvature_pair(1.5, 0.625);
  ASSERT_EQ(model.joins.size(), 1u);
  ASSERT_EQ(model.joins[0].smoothness, Smoothness::kCurvature);
  const auto relations = smooth_relations(model);
  ASSERT_EQ(relations.size(), 1u);
  EXPECT_EQ(relations[0].order, 2);
  EXPECT_EQ(relations[0].lambda, ratio(3, 2));
  EXPECT_EQ(relations[0].mu, ratio(5, 8));
  EXPECT_LT(relations[0].residual, 1e-14);
}

// Laws (4): a smooth join whose factor varies along it, and a sharp one.
TEST(SmoothRelations, NoConstantFactorNoRelation) {
  PatchModel model = testing::curvature_pair(1.0, 0.0);
  for (size_t j = 0; j < 4; ++j) {
    // Rows 1 and 2 at speeds of their own: normals agree only where the row is planar.
    for (size_t i = 0; i < 4; ++i) {
      model.points[4 * i + j] = Vec3(static_cast<double>(i), static_cast<double>(j), 0.0);
      const double speed = i == 0 ? 0.0 : 1.0 + 0.1 * static_cast<double>(j);
      model.points[16 + 4 * i + j] =
          Vec3(3.0 + speed * static_cast<double>(i), static_cast<double>(j), 0.0);
    }
  }
  model.joins = find_joins(model);
  ASSERT_EQ(model.joins[0].smoothness, Smoothness::kCurvature) << "both are planar";
  EXPECT_THAT(smooth_relations(model), IsEmpty());
  const auto without = [&] {
    derive_locks(model, {});
    return model.locks.size();
  }();
  derive_locks(model, smooth_relations(model));
  EXPECT_EQ(model.locks.size(), without) << "the lock stays";
  EXPECT_THAT(smooth_relations(testing::make_cube_model(2, 2)), IsEmpty());
}

TEST(SmoothRelations, LocksGiveWayToRelations) {
  std::mt19937 random(72);
  const KnotVector u = testing::random_clamped(random, 4, 5, 1);
  const KnotVector v = testing::random_clamped(random, 3, 3, 1);
  PatchModel model = cut_in_two(testing::random_surface(random, u, v, false), u.interior()[2]);
  const auto relations = smooth_relations(model);
  ASSERT_EQ(relations.size(), 1u);
  derive_locks(model, {});
  const std::set<int> before = locked_points(model);
  const auto locking = points_locking(model, relations[0]);
  EXPECT_EQ(std::set<int>(locking.begin(), locking.end()), before);
  derive_locks(model, relations);
  EXPECT_THAT(model.locks, IsEmpty());
}

TEST(SmoothRelations, KnotLinesAndTheSeamOfACircle) {
  PatchModel torus = testing::make_rational_torus(2.0, 0.5);
  torus.joins = find_joins(torus);
  const auto relations = smooth_relations(torus);
  int joins = 0;
  int lines = 0;
  for (const SmoothRelation& relation : relations) {
    joins += relation.kind == Kind::kJoin;
    lines += relation.kind == Kind::kKnotLine;
    EXPECT_EQ(relation.lambda, Rational(1));
    EXPECT_LT(relation.residual, 1e-14);
    ASSERT_FALSE(relation.equations.empty());
    EXPECT_EQ(relation.equations[0].size(), 1u) << "the weights separate";
    EXPECT_THAT(relation.text, ::testing::AnyOf(HasSubstr("face:1 meets itself smoothly (G1) at"),
                                                HasSubstr("(G1) across an inner knot line of ")));
  }
  EXPECT_EQ(joins, 2);
  EXPECT_EQ(lines, 6);
  derive_locks(torus, relations);
  EXPECT_THAT(torus.locks, IsEmpty());
  derive_locks(torus, {});
  std::set<int> union_of_relations;
  for (const SmoothRelation& relation : relations) {
    const auto points = points_locking(torus, relation);
    union_of_relations.insert(points.begin(), points.end());
  }
  // The locks of a seam also hold its curvature, which here is more than its degree can keep.
  const std::set<int> locked = locked_points(torus);
  EXPECT_TRUE(std::includes(locked.begin(), locked.end(), union_of_relations.begin(),
                            union_of_relations.end()));
}

TEST(SmoothRelations, WrapsOfPeriodicKnots) {
  PatchModel nose = testing::make_nose(1.0, 4.0, testing::Circle::kPeriodic);
  nose.joins = find_joins(nose);
  const auto relations = smooth_relations(nose);
  std::map<Kind, int> count;
  for (const SmoothRelation& relation : relations) {
    ++count[relation.kind];
    if (relation.kind != Kind::kWrap) continue;
    EXPECT_EQ(relation.text, "face:1 closes on itself smoothly (G1)");
    EXPECT_EQ(relation.join, 0);
    EXPECT_EQ(relation.order, 1);
    ASSERT_EQ(relation.equations.size(), 1u);
    ASSERT_EQ(relation.equations[0].size(), 1u);
    EXPECT_EQ(relation.equations[0][0].size(), 3u) << "poles -1, 0 and 1 around the seam";
  }
  EXPECT_EQ(count[Kind::kWrap], 1);
  EXPECT_EQ(count[Kind::kKnotLine], 4) << "three around, one along";
  EXPECT_EQ(count[Kind::kPole], 1);
  derive_locks(nose, relations);
  EXPECT_THAT(nose.locks, IsEmpty());
  // Without knots of full multiplicity nothing can break, and nothing is asked.
  PatchModel torus = testing::make_periodic_torus(3, 3, 8, 9);
  torus.joins = find_joins(torus);
  EXPECT_THAT(smooth_relations(torus), IsEmpty());
}

TEST(SmoothRelations, PolesWithATangentPlane) {
  PatchModel sphere = testing::make_sphere(1.0);
  sphere.joins = find_joins(sphere);
  std::vector<SmoothRelation> poles;
  for (SmoothRelation& relation : smooth_relations(sphere)) {
    if (relation.kind == Kind::kPole) poles.push_back(relation);
  }
  ASSERT_EQ(poles.size(), 2u);
  EXPECT_EQ(poles[0].text,
            "the point where side v0 of face:1 (\"sphere\") collapses has a tangent plane");
  EXPECT_EQ(points_locking(sphere, poles[0]).size(), 9u);
  // A cone's tip has none.
  const PatchModel cone =
      testing::make_revolved(KnotVector::uniform(1, 1), {{0.0, 0.0}, {1.0, 1.0}});
  for (const SmoothRelation& relation : smooth_relations(cone)) {
    EXPECT_NE(relation.kind, Kind::kPole);
  }
  // Nor has one whose second row is bent a little: smooth to the eye, but not to rows.
  sphere.points[static_cast<size_t>(sphere.patches[0].point(2, 1))].z() += 3e-5;
  int left = 0;
  for (const SmoothRelation& relation : smooth_relations(sphere)) {
    left += relation.kind == Kind::kPole;
  }
  EXPECT_EQ(left, 1);
}

}  // namespace
}  // namespace isochor
