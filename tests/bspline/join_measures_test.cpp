// Joins of constructed patches: what is smooth, by how much, and in whatever direction sides run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "isochor/bspline/joins.h"
#include "isochor/bspline/refinement.h"
#include "support/models.h"
#include "support/revolved.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::make_separate_model;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

KnotVector mirrored(const KnotVector& knots) {
  std::vector<double> values(knots.knots().rbegin(), knots.knots().rend());
  for (double& t : values) t = knots.begin() + (knots.end() - t);
  return KnotVector(knots.degree(), values);
}

// One of the eight ways to parametrise a surface over the same shape, and where its side u0 went.
struct Reoriented {
  Surface surface;
  Side side;          // what was u0
  bool side_flipped;  // it runs the other way now
  bool normal_flipped;
};

Reoriented reoriented(const Surface& s, bool flip_u, bool flip_v, bool swap) {
  const KnotVector u = flip_u ? mirrored(s.u_knots()) : s.u_knots();
  const KnotVector v = flip_v ? mirrored(s.v_knots()) : s.v_knots();
  std::vector<Vec3> poles;
  std::vector<double> weights;
  const int rows = swap ? s.v_size() : s.u_size();
  const int columns = swap ? s.u_size() : s.v_size();
  for (int a = 0; a < rows; ++a) {
    for (int b = 0; b < columns; ++b) {
      const int i = swap ? b : a;
      const int j = swap ? a : b;
      const size_t at = s.index(flip_u ? s.u_size() - 1 - i : i, flip_v ? s.v_size() - 1 - j : j);
      poles.push_back(s.poles()[at]);
      if (s.rational()) weights.push_back(s.weights()[at]);
    }
  }
  const Side side =
      swap ? (flip_u ? Side::kVEnd : Side::kVBegin) : (flip_u ? Side::kUEnd : Side::kUBegin);
  return {Surface(swap ? v : u, swap ? u : v, poles, weights), side, flip_v,
          (flip_u != flip_v) != swap};
}

// Half of a smooth surface, cut at the middle knot of u, which is there as often as the degree.
Surface half_of(const Surface& whole, bool second) {
  const KnotVector& u = whole.u_knots();
  const int d = u.degree();
  const double cut = u.breaks()[1];
  std::vector<double> knots;
  for (double t : u.knots()) {
    if (second ? t >= cut : t <= cut) knots.push_back(t);
  }
  knots.insert(second ? knots.begin() : knots.end(), cut);
  const KnotVector own(d, knots);
  const int first = second ? whole.u_size() - own.size() : 0;
  std::vector<Vec3> poles;
  std::vector<double> weights;
  for (int i = first; i < first + own.size(); ++i) {
    for (int j = 0; j < whole.v_size(); ++j) {
      poles.push_back(whole.pole(i, j));
      if (whole.rational()) weights.push_back(whole.weights()[whole.index(i, j)]);
    }
  }
  return Surface(own, whole.v_knots(), poles, weights);
}

// A random bicubic surface that is twice differentiable, ready to be cut at u = 0.4.
Surface smooth_whole(std::uint32_t seed, bool rational) {
  std::mt19937 random(seed);
  const KnotVector u = KnotVector::clamped(3, {0.0, 0.4, 1.0});
  const KnotVector v = testing::random_clamped(random, 3, 2, 1);
  const Surface base = testing::random_surface(random, u, v, rational);
  return refine(base, with_knots(u, {0.4, 0.4}), v);
}

// Law (2): however the two halves are parametrised, the join is the same.
TEST(JoinMeasures, DoNotDependOnTheParametrisation) {
  for (const bool rational : {false, true}) {
    const Surface whole = smooth_whole(351, rational);
    std::vector<Vec3> bent_poles = half_of(whole, true).poles();
    for (size_t j = 0; j < 6; ++j) bent_poles[6 + j] += Vec3(0.02, -0.01, 0.03);
    const Surface fore = half_of(whole, false);
    const Surface aft = half_of(whole, true);
    ASSERT_EQ(aft.v_size(), 6);
    const Surface bent(aft.u_knots(), aft.v_knots(), bent_poles, aft.weights());
    for (const Surface* other : {&aft, &bent}) {
      const Join plain = measure_join(make_separate_model({fore, *other}), {0, Side::kUEnd},
                                      {1, Side::kUBegin}, false);
      EXPECT_TRUE(plain.matching) << plain.mismatch;
      EXPECT_EQ(plain.smoothness == Smoothness::kCurvature, other == &aft);
      for (int way = 1; way < 8; ++way) {
        const Reoriented turned = reoriented(*other, way & 1, way & 2, way & 4);
        PatchModel model = make_separate_model({fore, turned.surface});
        model.patches[1].reversed = turned.normal_flipped;
        const Join join =
            measure_join(model, {0, Side::kUEnd}, {1, turned.side}, turned.side_flipped);
        EXPECT_TRUE(join.matching) << way << ' ' << join.mismatch;
        EXPECT_LT(join.max_gap, 1e-13);
        EXPECT_NEAR(join.max_angle_rad, plain.max_angle_rad, 1e-12) << way;
        EXPECT_NEAR(join.max_curvature_jump, plain.max_curvature_jump,
                    1e-10 * (1.0 + plain.max_curvature_jump));
        EXPECT_EQ(join.smoothness, plain.smoothness);
        const Join back =
            measure_join(model, {1, turned.side}, {0, Side::kUEnd}, turned.side_flipped);
        EXPECT_NEAR(back.max_angle_rad, join.max_angle_rad, 1e-14);
        EXPECT_NEAR(back.max_curvature_jump, join.max_curvature_jump, 1e-11);
        // With the flag wrong the normals are opposite: as sharp as can be.
        model.patches[1].reversed = !turned.normal_flipped;
        const Join wrong =
            measure_join(model, {0, Side::kUEnd}, {1, turned.side}, turned.side_flipped);
        EXPECT_GE(wrong.max_angle_rad, M_PI - plain.max_angle_rad - 1e-12);
      }
    }
  }
}

TEST(JoinMeasures, SpeedsAcrossDoNotMatterOnlyDirectionsDo) {
  const Surface whole = smooth_whole(352, false);
  const Surface fore = half_of(whole, false);
  Surface aft = half_of(whole, true);
  // Seven times faster across and over another domain: neither C1 nor C2 in the parameters.
  std::vector<double> knots = aft.u_knots().knots();
  for (double& t : knots) t = 5.0 + (t - 0.4) / 7.0;
  aft = Surface(KnotVector(3, knots), aft.v_knots(), aft.poles());
  const Vec3 slow = fore.derivatives(0.4, 0.7, 1, Limit::kFromBelow).su;
  const Vec3 fast = aft.derivatives(5.0, 0.7, 1).su;
  ASSERT_NEAR(fast.norm() / slow.norm(), 7.0, 1e-10);
  const Join join =
      measure_join(make_separate_model({fore, aft}), {0, Side::kUEnd}, {1, Side::kUBegin}, false);
  EXPECT_EQ(join.smoothness, Smoothness::kCurvature) << join.max_curvature_jump;
  // Tangent planes agree with another direction across, too: G1 without C1 of any scale. The second
  // row of poles slides along the boundary, which lies in a plane with it here.
  const KnotVector line = KnotVector::uniform(1, 1);
  const Surface flat(line, line, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}});
  const Surface sheared(line, line, {{1, 0, 0}, {1, 1, 0}, {1.5, 0.75, 0}, {3, 1.5, 0}});
  const Join slide = measure_join(make_separate_model({flat, sheared}), {0, Side::kUEnd},
                                  {1, Side::kUBegin}, false);
  EXPECT_EQ(slide.smoothness, Smoothness::kCurvature) << "both are flat";
}

// A quarter of a cylinder about the y axis: from the top to the right, radius r, axis at height c.
Surface quarter(double r, double c, double sense) {
  const double w = std::sqrt(0.5);
  return Surface(KnotVector::uniform(2, 1), KnotVector::uniform(1, 1),
                 {{0, 0, c + sense * r},
                  {0, 1, c + sense * r},
                  {r, 0, c + sense * r},
                  {r, 1, c + sense * r},
                  {r, 0, c},
                  {r, 1, c}},
                 {1, 1, w, w, 1, 1});
}

TEST(JoinMeasures, CurvatureJumpsOfArcsAreKnown) {
  for (const auto& [r, s] : {std::pair{1.0, 2.0}, std::pair{0.5, 0.75}, std::pair{3.0, 3.0}}) {
    // Both arcs start at the origin of x, tangent to x; the first one continued to the left.
    const Surface right = quarter(r, -r, 1.0);
    const Surface left = reoriented(quarter(s, -s, 1.0), true, false, false).surface;
    std::vector<Vec3> poles = left.poles();
    for (Vec3& p : poles) p.x() = -p.x();
    const Surface bulge(left.u_knots(), left.v_knots(), poles, left.weights());
    const Join same = measure_join(make_separate_model({bulge, right}), {0, Side::kUEnd},
                                   {1, Side::kUBegin}, false);
    EXPECT_NEAR(same.max_curvature_jump, std::abs(1.0 / r - 1.0 / s), 1e-12);
    EXPECT_EQ(same.smoothness, r == s ? Smoothness::kCurvature : Smoothness::kTangent);
    // An S: the right arc turns upwards instead.
    const Join across = measure_join(make_separate_model({bulge, quarter(r, r, -1.0)}),
                                     {0, Side::kUEnd}, {1, Side::kUBegin}, false);
    EXPECT_EQ(across.smoothness, Smoothness::kTangent) << across.max_angle_rad;
    EXPECT_NEAR(across.max_curvature_jump, 1.0 / r + 1.0 / s, 1e-12);
  }
}

TEST(JoinMeasures, ACapsuleIsTangentWhereTheDomeBegins) {
  // Profile: straight wall of radius r, then a quarter circle to the axis.
  const double r = 1.5;
  const double w = std::sqrt(0.5);
  const KnotVector arc = KnotVector::uniform(2, 1);
  const PatchModel wall = testing::make_revolved(KnotVector::uniform(1, 1), {{r, -2}, {r, 0}});
  const PatchModel dome = testing::make_revolved(arc, {{r, 0}, {r, r}, {0, r}}, {1, w, 1});
  const PatchModel model = make_separate_model({wall.surface(0), dome.surface(0)});
  const Join join = measure_join(model, {0, Side::kVEnd}, {1, Side::kVBegin}, false);
  EXPECT_TRUE(join.matching) << join.mismatch;
  EXPECT_EQ(join.smoothness, Smoothness::kTangent);
  EXPECT_NEAR(join.max_curvature_jump, 1.0 / r, 1e-12);
}

// Creases that run into a join are there on both sides: the join across them is as smooth as ever,
// also where the sides do not match and the corresponding parameter has to be found.
TEST(JoinMeasures, CreasesAlongTheSideAreNotCreasesAcrossIt) {
  std::mt19937 random(353);
  const KnotVector line = KnotVector::uniform(1, 1);
  for (int round = 0; round < 20; ++round) {
    std::vector<double> breaks = {testing::uniform(random, -1, 0)};
    for (int k = 0; k < 5; ++k) breaks.push_back(breaks.back() + testing::uniform(random, 0.1, 1));
    const KnotVector along = KnotVector::clamped(1, breaks);
    std::vector<Vec3> near;
    std::vector<Vec3> far;
    for (double x : {0.0, 1.0, 2.5}) {
      for (int j = 0; j < along.size(); ++j) {
        const Vec3 p(x, along.greville(j), (j % 2) * 0.7);
        if (x <= 1.0) near.push_back(p);
        if (x >= 1.0) far.push_back(p);
      }
    }
    const Surface a(line, along, near);
    const Surface b(line, along, far);
    const KnotVector more = with_knots(along, {0.5 * (breaks[0] + breaks[1])});
    const Join matching =
        measure_join(make_separate_model({a, b}), {0, Side::kUEnd}, {1, Side::kUBegin}, false);
    EXPECT_EQ(matching.smoothness, Smoothness::kCurvature);
    const Surface finer = refine(b, line, more);
    const Join join =
        measure_join(make_separate_model({a, finer}), {0, Side::kUEnd}, {1, Side::kUBegin}, false);
    EXPECT_FALSE(join.matching);
    EXPECT_LT(join.max_angle_rad, 1e-12) << round;
    EXPECT_EQ(join.smoothness, Smoothness::kCurvature);
    // The same with the second side running the other way over another domain.
    const Reoriented turned = reoriented(finer, true, true, false);
    const Join opposed = measure_join(make_separate_model({a, turned.surface}), {0, Side::kUEnd},
                                      {1, turned.side}, true);
    EXPECT_LT(opposed.max_angle_rad, 1e-12) << round;
    EXPECT_LT(join.max_gap, 1e-14);
    EXPECT_LT(opposed.max_gap, 1e-14);
  }
}

// The same curve with other knots has no gap and no angle, however wild it is: for every sample the
// right one of many near misses has to be found.
TEST(JoinMeasures, WildCurvesWithOtherKnotsHaveNoGap) {
  std::mt19937 random(355);
  for (int round = 0; round < 150; ++round) {
    const KnotVector u = testing::random_clamped(random, 2, 1);
    const KnotVector v = testing::random_clamped(random, 1 + round % 6, round % 5);
    const Surface a = testing::random_surface(random, u, v, round % 2 == 1);
    const Surface b =
        refine(a, u, with_knots(v, testing::random_insertions(random, v, 1 + round % 4)));
    const bool opposed = round % 3 == 0;
    const Reoriented other = reoriented(b, false, opposed, false);
    PatchModel model = make_separate_model({a, other.surface});
    model.patches[1].reversed = other.normal_flipped;
    const Join join = measure_join(model, {0, Side::kUEnd}, {1, Side::kUEnd}, opposed);
    EXPECT_FALSE(join.matching);
    EXPECT_LT(join.max_gap, 1e-12) << round;
    EXPECT_LT(join.max_angle_rad, 1e-6) << round;
  }
}

// Two curves of the same points at different speeds: equal shares of the domain are not equal
// points, so that the nearest ones have to be found without help.
TEST(JoinMeasures, OtherSpeedsAlongTheCurveHaveNoGap) {
  std::mt19937 random(356);
  for (int round = 0; round < 40; ++round) {
    const int degree = 2 + round % 3;
    const KnotVector line = KnotVector::uniform(1, 1);
    const KnotVector v = KnotVector::uniform(degree, 1);
    const Surface a = testing::random_surface(random, line, v, false);
    // The Moebius map t -> c t / (1 - t + c t) of a Bezier curve gives its poles the weights c^j.
    const double c = round % 2 == 0 ? 3.0 : 0.4;
    std::vector<double> weights;
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j <= degree; ++j) weights.push_back(std::pow(c, j));
    }
    const PatchModel model = make_separate_model({a, Surface(line, v, a.poles(), weights)});
    const Join join = measure_join(model, {0, Side::kUEnd}, {1, Side::kUEnd}, false);
    EXPECT_THAT(join.mismatch, HasSubstr("weight"));
    EXPECT_LT(join.max_gap, 1e-13) << round;
    EXPECT_LT(join.max_angle_rad, 1e-7) << round;
  }
}

TEST(JoinMeasures, ATJunctionHasTheGapOfTheShorterSide) {
  const KnotVector line = KnotVector::uniform(1, 1);
  const Surface full(line, line, {{0, 0, 0}, {0, 2, 0}, {1, 0, 0}, {1, 2, 0}});
  const Surface half(line, line, {{1, 0, 0}, {1, 1, 0}, {2, 0, 0}, {2, 1, 0}});
  const PatchModel model = make_separate_model({full, half});
  const Join join = measure_join(model, {0, Side::kUEnd}, {1, Side::kUBegin}, false);
  EXPECT_FALSE(join.matching);
  EXPECT_EQ(join.mismatch, "the poles lie up to 1 apart");
  EXPECT_NEAR(join.max_gap, 1.0, 1e-14) << "the far end of the longer side has no partner";
  EXPECT_EQ(join_gap(model, model.points, join), join.max_gap);
  // Seen only along the shorter side, the junction is tight.
  std::vector<Vec3> at = model.points;
  at[1] = Vec3(0, 1, 0);
  at[3] = Vec3(1, 1, 0);
  EXPECT_LT(measure_join(model, at, join.a, join.b, false).max_gap, 1e-14);
  EXPECT_TRUE(measure_join(model, at, join.a, join.b, false).matching);
}

TEST(JoinMeasures, GapsOfMovedPointsAreMeasuredOnBothPaths) {
  const Surface whole = smooth_whole(354, true);
  const Surface fore = half_of(whole, false);
  const Surface aft = half_of(whole, true);
  const KnotVector more = with_knots(aft.v_knots(), {0.5 * aft.v_knots().breaks()[1]});
  for (const Surface& other : {aft, refine(aft, aft.u_knots(), more)}) {
    const PatchModel model = make_separate_model({fore, other});
    const Join join = measure_join(model, {0, Side::kUEnd}, {1, Side::kUBegin}, false);
    EXPECT_LT(join.max_gap, 1e-12);
    std::vector<Vec3> at = model.points;
    for (size_t i = fore.poles().size(); i < at.size(); ++i) at[i] += Vec3(0, 0, 1e-3);
    const Join moved = measure_join(model, at, join.a, join.b, false);
    EXPECT_GT(join_gap(model, at, join), 1e-4);
    EXPECT_LE(join_gap(model, at, join), 1e-3 * (1 + 1e-9));
    if (join.matching && moved.matching) {
      EXPECT_EQ(moved.max_gap, join_gap(model, at, join));
    }
  }
}

TEST(JoinMeasures, ThreeSidesOnOneCurveAreThreeJoins) {
  PatchModel model;
  model.points = {{0, 0, 0},  {0, 1, 0},  {1, 0, 0}, {1, 1, 0},
                  {-1, 0, 1}, {-1, 1, 1}, {0, 0, 2}, {0, 1, 2}};
  const KnotVector line = KnotVector::uniform(1, 1);
  for (const std::vector<int>& points :
       {std::vector<int>{0, 1, 2, 3}, std::vector<int>{0, 1, 4, 5}, std::vector<int>{1, 0, 7, 6}}) {
    const std::string handle = "face:" + std::to_string(model.patches.size() + 1);
    model.patches.push_back({"", handle, line, line, points, {}, false, {}, {}});
  }
  const std::vector<Join> joins = find_joins(model);
  ASSERT_EQ(joins.size(), 3u);
  EXPECT_FALSE(joins[0].opposed);
  EXPECT_TRUE(joins[1].opposed);
  EXPECT_TRUE(joins[2].opposed);
  EXPECT_NEAR(joins[0].max_angle_rad, 0.75 * M_PI, 1e-15);
  const Closure closed = closure(model);
  EXPECT_FALSE(closed.closed);
  EXPECT_THAT(closed.overused_sides,
              ElementsAre("side u0 of face:1", "side u0 of face:2", "side u0 of face:3"));
  EXPECT_EQ(closed.open_sides.size(), 9u);
}

TEST(JoinMeasures, LabelsNameFacesAndSides) {
  PatchModel model = testing::make_cube_model(1, 1);
  EXPECT_EQ(label_of(model.patches[0]), "face:1 (\"top\")");
  EXPECT_EQ(label_of(model, {5, Side::kVEnd}), "side v1 of face:6 (\"front\")");
  model.patches[0].name.clear();
  EXPECT_EQ(label_of(model.patches[0]), "face:1");
}

TEST(JoinMeasures, SingularSidesHaveNoNormalToCompare) {
  // Two triangles that meet in their tips: no tangent plane anywhere along the "side".
  const KnotVector line = KnotVector::uniform(1, 1);
  const Surface one(line, line, {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}});
  const Surface two(line, line, {{0, 0, 0}, {0, 0, 0}, {-1, 0, 0}, {-1, 1, 0}});
  const Join join =
      measure_join(make_separate_model({one, two}), {0, Side::kUBegin}, {1, Side::kUBegin}, false);
  EXPECT_EQ(join.smoothness, Smoothness::kSharp);
  EXPECT_EQ(join.max_gap, 0.0);
}

}  // namespace
}  // namespace isochor
