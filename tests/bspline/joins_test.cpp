#include "isochor/bspline/joins.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "isochor/bspline/refinement.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::make_cube_model;
using ::isochor::testing::make_cylinder;
using ::isochor::testing::make_periodic_torus;
using ::isochor::testing::make_sphere;
using ::isochor::testing::random_closed_model;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Joins, ACubeHasTwelveSharpOnes) {
  const PatchModel model = make_cube_model(3, 4);
  const std::vector<Join> joins = find_joins(model);
  ASSERT_EQ(joins.size(), 12u);
  for (const Join& join : joins) {
    EXPECT_TRUE(join.matching) << join.mismatch;
    EXPECT_LT(join.max_gap, 1e-15);
    EXPECT_NEAR(join.max_angle_rad, M_PI / 2, 1e-12);
    EXPECT_EQ(join.smoothness, Smoothness::kSharp);
    EXPECT_EQ(join_gap(model, model.points, join), join.max_gap);
  }
  const Closure closed = closure(model);
  EXPECT_TRUE(closed.closed);
  EXPECT_LT(closed.vector_area, 1e-15);
}

TEST(Joins, BentModelsStayClosed) {
  for (std::uint32_t seed : {1u, 2u, 3u}) {
    testing::RandomModelOptions options;
    options.degrees[0] = 2;
    options.degrees[2] = 5;
    options.weight_ratio = seed == 3 ? 4.0 : 1.0;
    PatchModel model = random_closed_model(seed, options);
    EXPECT_EQ(find_joins(model).size(), 12u);
    for (const Join& join : find_joins(model)) EXPECT_TRUE(join.matching) << join.mismatch;
    EXPECT_TRUE(closure(model).closed);
    EXPECT_LT(closure(model).vector_area, 1e-14);
    // Far from the origin the second check still works.
    testing::translate(model, Vec3(1e6, -2e6, 3e6));
    EXPECT_LT(closure(model).vector_area, 1e-8);
  }
}

TEST(Joins, TiesJoinSeparatePoints) {
  PatchModel shared = make_cube_model(2, 3);
  std::vector<Surface> surfaces;
  for (int q = 0; q < 6; ++q) surfaces.push_back(shared.surface(q));
  PatchModel model = testing::make_separate_model(surfaces);
  EXPECT_THAT(find_joins(model), IsEmpty());
  EXPECT_EQ(closure(model).open_sides.size(), 24u);
  for (size_t i = 0; i < model.points.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (model.points[i] == model.points[j]) model.ties.emplace_back(j, i);
    }
  }
  const auto tied = find_joins(model);
  const auto expected = find_joins(shared);
  ASSERT_EQ(tied.size(), expected.size());
  for (size_t i = 0; i < tied.size(); ++i) {
    EXPECT_EQ(tied[i].a, expected[i].a);
    EXPECT_EQ(tied[i].b, expected[i].b);
    EXPECT_EQ(tied[i].opposed, expected[i].opposed);
  }
  EXPECT_TRUE(closure(model).closed);
}

TEST(Joins, ATorusWrapsSmoothlyBothWays) {
  const PatchModel model = make_periodic_torus(3, 4, 8, 9);
  const auto joins = find_joins(model);
  ASSERT_EQ(joins.size(), 2u);
  for (const Join& join : joins) {
    EXPECT_TRUE(join.matching);
    EXPECT_EQ(join.smoothness, Smoothness::kCurvature);
    EXPECT_LT(join.max_gap, 1e-14);
  }
  EXPECT_TRUE(closure(model).closed);
  const PointClasses classes = point_classes(model);
  EXPECT_EQ(wrapped_rows(model.patches[0], Direction::kU, classes), 3);
  EXPECT_EQ(wrapped_rows(model.patches[0], Direction::kV, classes), 4);
  PatchModel torn = model;
  torn.points.push_back(torn.points[0]);
  torn.patches[0].points[0] = static_cast<int>(torn.points.size()) - 1;
  EXPECT_EQ(wrapped_rows(torn.patches[0], Direction::kU, point_classes(torn)), 0);
  EXPECT_FALSE(closure(torn).closed);
}

TEST(Joins, ASphereHasOneSeamAndTwoPoles) {
  const PatchModel model = make_sphere(2.0);
  const auto joins = find_joins(model);
  ASSERT_EQ(joins.size(), 1u);
  EXPECT_EQ(joins[0].a.patch, joins[0].b.patch);
  EXPECT_FALSE(joins[0].opposed);
  EXPECT_TRUE(joins[0].matching) << joins[0].mismatch;
  EXPECT_EQ(joins[0].smoothness, Smoothness::kCurvature);
  const PointClasses classes = point_classes(model);
  int collapsed = 0;
  for (Side side : kSides) collapsed += is_collapsed(model.patches[0], side, classes);
  EXPECT_EQ(collapsed, 2);
  EXPECT_TRUE(closure(model).closed);
}

TEST(Joins, ACylinderIsClosedWithSharpRims) {
  const PatchModel model = make_cylinder(1.0, 3.0);
  EXPECT_TRUE(closure(model).closed) << ::testing::PrintToString(closure(model).open_sides);
  int sharp = 0;
  for (const Join& join : find_joins(model)) sharp += join.smoothness == Smoothness::kSharp;
  EXPECT_GE(sharp, 2);
}

TEST(Joins, ClosureNamesWhatIsWrong) {
  PatchModel open = make_cube_model(2, 2);
  open.patches[5].name = "front";
  const PatchModel whole = open;
  open.patches.pop_back();
  EXPECT_FALSE(closure(open).closed);
  EXPECT_EQ(closure(open).open_sides.size(), 4u);
  EXPECT_THAT(closure(open).open_sides[0], HasSubstr("side "));
  EXPECT_GT(closure(open).vector_area, 0.1);

  PatchModel turned = whole;
  turned.patches[5].reversed = !turned.patches[5].reversed;
  EXPECT_FALSE(closure(turned).closed);
  EXPECT_EQ(closure(turned).misoriented_sides.size(), 4u);
  EXPECT_THAT(closure(turned).misoriented_sides[0], HasSubstr("face:6 (\"front\")"));
  EXPECT_GT(closure(turned).vector_area, 0.1);

  PatchModel doubled = whole;
  doubled.patches.push_back(doubled.patches[0]);
  doubled.patches.back().handle = "face:7";
  EXPECT_FALSE(closure(doubled).closed);
  EXPECT_EQ(closure(doubled).overused_sides.size(), 12u);
  EXPECT_FALSE(closure(PatchModel{}).closed);
}

TEST(Joins, AFoldedSideNeedsNoPartner) {
  // A bag: a bilinear strip folded at the middle pole row; side v0 is glued to itself.
  PatchModel model;
  const KnotVector u = KnotVector::clamped(1, {0.0, 0.5, 1.0});
  const KnotVector v = KnotVector::uniform(1, 1);
  model.points = {{0, 0, 0}, {0, 1, 1}, {1, 0, 0}, {1, 1, 0}, {0, 1, -1}};
  model.patches.push_back({"", "face:1", u, v, {0, 1, 2, 3, 0, 4}, {}, false, {}, {}});
  const auto open = closure(model).open_sides;
  EXPECT_THAT(open, ElementsAre(HasSubstr("u0"), HasSubstr("u1"), HasSubstr("v1")));
}

// A quarter cylinder of radius r, u around, from angle 0; and a flat patch tangent to it at u = 0.
Surface quarter_cylinder(double r) {
  const double w = std::sqrt(0.5);
  return Surface(KnotVector::uniform(2, 1), KnotVector::uniform(1, 1),
                 {{0, 0, r}, {0, 1, r}, {r, 0, r}, {r, 1, r}, {r, 0, 0}, {r, 1, 0}},
                 {1, 1, w, w, 1, 1});
}

TEST(Joins, TangentJoinMeasuresTheCurvatureJump) {
  for (double r : {0.5, 2.0}) {
    const Surface flat(KnotVector::uniform(1, 1), KnotVector::uniform(1, 1),
                       {{-1, 0, r}, {-1, 1, r}, {0, 0, r}, {0, 1, r}});
    const PatchModel model = testing::make_separate_model({flat, quarter_cylinder(r)});
    const Join join = measure_join(model, {0, Side::kUEnd}, {1, Side::kUBegin}, false);
    EXPECT_TRUE(join.matching) << join.mismatch;
    EXPECT_EQ(join.smoothness, Smoothness::kTangent);
    EXPECT_NEAR(join.max_curvature_jump, 1.0 / r, 1e-12);
    const Join back = measure_join(model, {1, Side::kUBegin}, {0, Side::kUEnd}, false);
    EXPECT_EQ(back.max_gap, join.max_gap);
    EXPECT_EQ(back.max_angle_rad, join.max_angle_rad);
    EXPECT_EQ(back.max_curvature_jump, join.max_curvature_jump);
  }
}

TEST(Joins, MeasuresFollowRotationAndScale) {
  const Surface flat(KnotVector::uniform(1, 1), KnotVector::uniform(1, 1),
                     {{-1, 0, 1}, {-1, 1, 1.01}, {0, 0, 1}, {0, 1, 1}});
  PatchModel model = testing::make_separate_model({flat, quarter_cylinder(1.0)});
  const SideRef a{0, Side::kUEnd};
  const SideRef b{1, Side::kUBegin};
  const Join before = measure_join(model, a, b, false);
  EXPECT_EQ(before.smoothness, Smoothness::kAlmost);
  for (double scale : {1e9, 1e-9}) {
    PatchModel other = model;
    const Eigen::AngleAxisd turn(1.1, Vec3(1, 2, 3).normalized());
    testing::transform(other, scale * turn.toRotationMatrix());
    const Join after = measure_join(other, a, b, false);
    EXPECT_EQ(after.matching, before.matching);
    EXPECT_NEAR(after.max_angle_rad, before.max_angle_rad, 1e-12);
    EXPECT_NEAR(after.max_curvature_jump * scale, before.max_curvature_jump, 1e-10);
    EXPECT_EQ(after.smoothness, before.smoothness);
  }
}

TEST(Joins, MismatchesAreExplained) {
  std::mt19937 random(41);
  const KnotVector u = testing::random_clamped(random, 3, 2, 1);
  const KnotVector v = testing::random_clamped(random, 3, 2, 1);
  const Surface surface = testing::random_surface(random, u, v, false);
  const KnotVector finer = with_knots(v, {0.5 * (v.begin() + v.breaks()[1])});
  const SideRef a{0, Side::kUBegin};
  const SideRef b{1, Side::kUBegin};
  const auto join_with = [&](const Surface& other) {
    return measure_join(testing::make_separate_model({surface, other}), a, b, false);
  };
  EXPECT_TRUE(join_with(surface).matching);

  // The same curve with one more knot: not matching, yet without a gap.
  const Join knots = join_with(refine(surface, u, finer));
  EXPECT_FALSE(knots.matching);
  EXPECT_THAT(knots.mismatch, HasSubstr("6 poles against 7"));
  EXPECT_LT(knots.max_gap, 1e-12);

  const KnotVector moved = with_knots(with_knots(KnotVector::uniform(3, 1, v.begin(), v.end()), {}),
                                      {v.breaks()[1] * 0.9, v.breaks()[2]});
  EXPECT_THAT(join_with(Surface(u, moved, surface.poles())).mismatch, HasSubstr("knot 0."));

  std::vector<double> weights(surface.poles().size(), 2.0);
  EXPECT_TRUE(join_with(Surface(u, v, surface.poles(), weights)).matching) << "common factor";
  weights[1] = 3.0;
  EXPECT_THAT(join_with(Surface(u, v, surface.poles(), weights)).mismatch, HasSubstr("weight"));

  std::vector<Vec3> poles = surface.poles();
  poles[1] += Vec3(0.25, 0, 0);
  const Join apart = join_with(Surface(u, v, poles));
  EXPECT_THAT(apart.mismatch, HasSubstr("the poles lie up to 0.25 apart"));
  EXPECT_GT(apart.max_gap, 0.01);

  const Surface quadratic = testing::random_surface(random, u, KnotVector::uniform(2, 3), false);
  EXPECT_THAT(join_with(quadratic).mismatch, HasSubstr("degree 3 against 2"));
  const Surface unclamped =
      testing::random_surface(random, testing::random_unclamped(random, 3), v, false);
  EXPECT_THAT(join_with(unclamped).mismatch, HasSubstr("side u0 of face:2 are not clamped"));
}

TEST(Joins, OpposedSidesMatchMirroredKnots) {
  std::mt19937 random(42);
  const KnotVector v = KnotVector::clamped(3, {0.0, 0.3, 1.0});
  const KnotVector mirrored = KnotVector::clamped(3, {5.0, 6.4, 7.0});
  const KnotVector u = KnotVector::uniform(2, 2);
  const Surface first = testing::random_surface(random, u, v, false);
  std::vector<Vec3> poles;
  for (int i = 0; i < first.u_size(); ++i) {
    for (int j = first.v_size() - 1; j >= 0; --j) poles.push_back(first.pole(i, j));
  }
  const PatchModel model = testing::make_separate_model({first, Surface(u, mirrored, poles)});
  const Join join = measure_join(model, {0, Side::kUEnd}, {1, Side::kUEnd}, true);
  EXPECT_TRUE(join.matching) << join.mismatch;
  EXPECT_LT(join.max_gap, 1e-14);
  EXPECT_FALSE(measure_join(model, {0, Side::kUEnd}, {1, Side::kUEnd}, false).matching);
}

}  // namespace
}  // namespace isochor
