#include "isochor/bspline/closest_point.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "isochor/base/error.h"
#include "isochor/bspline/trims.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

// A gently waved surface: heights are random, the ground plan is a regular grid.
Surface waved(std::mt19937& random, const KnotVector& u, const KnotVector& v, bool rational) {
  std::vector<Vec3> poles;
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      poles.emplace_back(u.greville(i), v.greville(j), 0.3 * testing::uniform(random, -1, 1));
    }
  }
  const auto weights =
      rational ? testing::random_weights(random, poles.size()) : std::vector<double>{};
  return Surface(u, v, poles, weights);
}

double sampled_distance(const Surface& surface, const Vec3& p, int count) {
  double best = std::numeric_limits<double>::infinity();
  const KnotVector& u = surface.u_knots();
  const KnotVector& v = surface.v_knots();
  for (int i = 0; i <= count; ++i) {
    for (int j = 0; j <= count; ++j) {
      const Vec3 s = surface.point(u.begin() + (u.end() - u.begin()) * i / count,
                                   v.begin() + (v.end() - v.begin()) * j / count);
      best = std::min(best, (s - p).norm());
    }
  }
  return best;
}

TEST(ClosestPoint, NoSampleIsNearer) {
  std::mt19937 random(91);
  for (bool rational : {false, true}) {
    for (int round = 0; round < 4; ++round) {
      const Surface surface = waved(random, testing::random_clamped(random, 3, 3, 3),
                                    testing::random_unclamped(random, 2, 4), rational);
      for (int k = 0; k < 5; ++k) {
        const Vec3 p(testing::uniform(random, -1, 4), testing::uniform(random, -1, 4),
                     testing::uniform(random, -2, 2));
        const ClosestPoint got = closest_point(surface, p);
        ASSERT_EQ(got.patch, 0);
        EXPECT_LE(got.distance, sampled_distance(surface, p, 40) + 1e-14);
        EXPECT_EQ(got.point, surface.point(got.uv.u, got.uv.v));
        EXPECT_EQ(got.distance, (got.point - p).norm());
      }
    }
  }
}

TEST(ClosestPoint, PointsOfTheSurfaceAreFound) {
  std::mt19937 random(92);
  for (double scale : {1.0, 1e9, 1e-9}) {
    const Surface base = waved(random, testing::random_clamped(random, 3, 4, 1),
                               testing::random_clamped(random, 4, 2, 1), false);
    std::vector<Vec3> poles = base.poles();
    for (Vec3& p : poles) p *= scale;
    const Surface surface(base.u_knots(), base.v_knots(), poles);
    for (double s : {0.0, 0.13, 0.5, 0.86, 1.0}) {
      for (double t : {0.0, 0.37, 1.0}) {
        const double u = s * surface.u_knots().end();
        const double v = t * surface.v_knots().end();
        const ClosestPoint on = closest_point(surface, surface.point(u, v));
        EXPECT_LT(on.distance, 1e-14 * scale);
        EXPECT_NEAR(on.uv.u, u, 1e-12);
        EXPECT_NEAR(on.uv.v, v, 1e-12);
        if (s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0) {
          const Vec3 off = surface.point(u, v) + 0.02 * scale * surface.normal(u, v);
          const ClosestPoint foot = closest_point(surface, off);
          EXPECT_NEAR(foot.uv.u, u, 1e-11);
          EXPECT_NEAR(foot.uv.v, v, 1e-11);
          EXPECT_NEAR(foot.distance / scale, 0.02, 1e-12);
        }
      }
    }
  }
}

TEST(ClosestPoint, DistanceToASphereIsRadial) {
  std::mt19937 random(93);
  const PatchModel model = testing::make_sphere(2.0);
  for (int k = 0; k < 20; ++k) {
    const Vec3 p = 5.0 * testing::random_points(random, 1)[0];
    const ClosestPoint got = closest_point(model, p);
    EXPECT_NEAR(got.distance, std::abs(p.norm() - 2.0), 1e-12);
    EXPECT_LT((got.point - 2.0 * p.normalized()).norm(), 1e-7);
  }
  // Straight above the pole, where the parametrisation is singular.
  const ClosestPoint pole = closest_point(model, Vec3(0, 0, 3));
  EXPECT_NEAR(pole.distance, 1.0, 1e-12);
  // The centre: every point is nearest.
  EXPECT_NEAR(closest_point(model, Vec3::Zero()).distance, 2.0, 1e-12);
}

TEST(ClosestPoint, CreasesAreReached) {
  // A roof: the ridge at u = 0.4 is a C0 knot line.
  const Surface roof(KnotVector::clamped(1, {0, 0.4, 1}), KnotVector::uniform(1, 1),
                     {{-1, 0, 0}, {-1, 2, 0}, {0, 0, 1}, {0, 2, 1}, {1, 0, 0}, {1, 2, 0}});
  const ClosestPoint ridge = closest_point(roof, Vec3(0.1, 1.3, 3));
  EXPECT_NEAR(ridge.uv.u, 0.4, 1e-15);
  EXPECT_NEAR(ridge.uv.v, 0.65, 1e-14);
  // The nearest sample is on the ridge and starts the search on the far slope.
  const ClosestPoint slope = closest_point(roof, roof.point(0.37, 0.4));
  EXPECT_NEAR(slope.uv.u, 0.37, 1e-14);
  EXPECT_LT(slope.distance, 1e-15);
  const ClosestPoint eaves = closest_point(roof, Vec3(4, -1, 0));
  EXPECT_EQ(eaves.uv.u, 1.0);
  EXPECT_EQ(eaves.uv.v, 0.0);
}

TEST(ClosestPoint, TrimmedPartsDoNotCount) {
  const PatchModel cube = testing::make_cube_model(3, 4);
  const Surface top = cube.surface(0);
  TrimRegion trim;
  trim.loops = {{{0.25, 0.25}, {0.75, 0.25}, {0.75, 0.75}, {0.25, 0.75}}};
  const ClosestPoint above = closest_point(top, trim, Vec3(0.5, 0.5, 2));
  EXPECT_NEAR(above.distance, 1.0, 1e-14);
  const ClosestPoint beside = closest_point(top, trim, Vec3(0.9, 0.6, 1));
  EXPECT_NEAR(beside.uv.u, 0.75, 1e-9);
  EXPECT_NEAR(beside.uv.v, 0.6, 1e-6);
  EXPECT_NEAR(beside.distance, 0.15, 1e-9);
  // The hole of a window: outer loop and inner loop.
  trim.loops.push_back({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const ClosestPoint window = closest_point(top, trim, Vec3(0.5, 0.3, 1.5));
  EXPECT_NEAR(window.uv.v, 0.25, 1e-9);
  EXPECT_NEAR(window.distance, std::hypot(0.05, 0.5), 1e-9);
}

TEST(ClosestPoint, TheModelPicksTheFace) {
  const PatchModel cube = testing::make_cube_model(3, 3);
  EXPECT_EQ(closest_point(cube, Vec3(0.3, 0.6, 2)).patch, 0);
  EXPECT_EQ(closest_point(cube, Vec3(0.3, 0.6, -2)).patch, 1);
  EXPECT_EQ(closest_point(cube, Vec3(0.9, 0.5, 0.5)).patch, 2);
  EXPECT_NEAR(closest_point(cube, Vec3(2, 2, 2)).distance, std::sqrt(3.0), 1e-14);
  EXPECT_EQ(closest_point(PatchModel{}, Vec3::Zero()).patch, -1);
  EXPECT_THROW(closest_point(cube, Vec3(0, std::nan(""), 0)), PreconditionError);
}

}  // namespace
}  // namespace isochor
