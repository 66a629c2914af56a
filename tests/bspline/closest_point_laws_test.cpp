// The laws of closest_point at seams, poles, creases, ties and far away.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "isochor/base/error.h"
#include "isochor/bspline/closest_point.h"
#include "isochor/bspline/trims.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::make_cylinder;
using ::isochor::testing::make_sphere;
using ::isochor::testing::random_clamped;
using ::isochor::testing::random_surface;
using ::isochor::testing::random_unclamped;
using ::isochor::testing::uniform;

// Law (2): the cosine between the difference and each derivative is zero inside an element; on a
// border the difference must not fall towards the inside.
void expect_stationary(const Surface& surface, const Vec3& p, const ClosestPoint& got) {
  if (got.distance < 1e-7) return;  // the direction of the difference is rounding
  const auto check = [&](double t, const KnotVector& knots, const Vec3& below, const Vec3& above) {
    const Vec3 r = (got.point - p) / got.distance;
    const auto cosine = [&](const Vec3& d) { return d.norm() > 1e-9 ? r.dot(d) / d.norm() : 0.0; };
    constexpr double kRounding = 1e-6;  // the parameter is known to the root of the distance's
    if (t > knots.begin()) {
      EXPECT_LE(cosine(below), kRounding);
    }
    if (t < knots.end()) {
      EXPECT_GE(cosine(above), -kRounding);
    }
  };
  const auto at = [&](Limit u, Limit v) {
    return surface.derivatives(got.uv.u, got.uv.v, 1, u, v);
  };
  const Limit above = Limit::kFromAbove;
  const Limit below = Limit::kFromBelow;
  check(got.uv.u, surface.u_knots(), at(below, above).su, at(above, above).su);
  check(got.uv.u, surface.u_knots(), at(below, below).su, at(above, below).su);
  check(got.uv.v, surface.v_knots(), at(above, below).sv, at(above, above).sv);
  check(got.uv.v, surface.v_knots(), at(below, below).sv, at(below, above).sv);
}

double sampled_distance(const Surface& surface, const Vec3& p, int per_span) {
  double best = std::numeric_limits<double>::infinity();
  for (double u : testing::sample_parameters(surface.u_knots(), per_span)) {
    for (double v : testing::sample_parameters(surface.v_knots(), per_span)) {
      best = std::min(best, (surface.point(u, v) - p).norm());
    }
  }
  return best;
}

TEST(ClosestPointLaws, WildSurfacesOfAllKindsOfKnots) {
  std::mt19937 random(341);
  for (int round = 0; round < 12; ++round) {
    const int degree = 1 + round % 5;
    const Surface surface = random_surface(random, random_clamped(random, degree, 2),
                                           random_unclamped(random, 1 + round % 3, 2), round > 5);
    for (int k = 0; k < 4; ++k) {
      const Vec3 p = (k == 0 ? 30.0 : 1.5) * testing::random_points(random, 1)[0];
      const ClosestPoint got = closest_point(surface, p);
      EXPECT_LE(got.distance, sampled_distance(surface, p, 8) + 1e-14);
      EXPECT_EQ(got.point, surface.point(got.uv.u, got.uv.v));
      expect_stationary(surface, p, got);
    }
  }
}

TEST(ClosestPointLaws, FarAwayTheDirectionStillCounts) {
  std::mt19937 random(342);
  const Surface surface = random_surface(random, random_clamped(random, 3, 2, 1),
                                         random_clamped(random, 3, 2, 1), false);
  for (double far : {1e3, 1e6, 1e9}) {
    const Vec3 direction = testing::random_points(random, 1)[0].normalized();
    const Vec3 p = far * direction;
    const ClosestPoint got = closest_point(surface, p);
    // Seen from far away the nearest point is the one that lies farthest in the direction; rounding
    // of the distance hides far * eps.
    double reach = -std::numeric_limits<double>::infinity();
    for (double u : testing::sample_parameters(surface.u_knots(), 9)) {
      for (double v : testing::sample_parameters(surface.v_knots(), 9)) {
        reach = std::max(reach, surface.point(u, v).dot(direction));
      }
    }
    EXPECT_GE(got.point.dot(direction), reach - 8.0 / far - 4e-16 * far) << far;
  }
}

TEST(ClosestPointLaws, SeamsAreCrossedFromBothSides) {
  const PatchModel cylinder = make_cylinder(2.0, 3.0);
  const Surface wall = cylinder.surface(0);
  for (double angle : {-1e-3, -1e-9, 0.0, 1e-9, 1e-3}) {
    const Vec3 outward(std::cos(angle), std::sin(angle), 0.0);
    const ClosestPoint got = closest_point(wall, 5.0 * outward + Vec3(0, 0, 1.25));
    EXPECT_NEAR(got.distance, 3.0, 1e-14);
    EXPECT_LT((got.point - 2.0 * outward - Vec3(0, 0, 1.25)).norm(), 4e-9) << angle;
  }
  // Around a periodic direction without a clamped seam.
  const PatchModel torus = testing::make_periodic_torus(3, 3, 9, 8);
  const Surface surface = torus.surface(0);
  const double period = surface.u_knots().end() - surface.u_knots().begin();
  for (double share : {0.001, 0.5, 0.999}) {
    const double u = surface.u_knots().begin() + share * period;
    const double v = surface.v_knots().end() - 0.002;
    const ClosestPoint got = closest_point(surface, surface.point(u, v));
    EXPECT_LT(got.distance, 1e-14);
    EXPECT_LT((got.point - surface.point(u, v)).norm(), 1e-14);
  }
}

TEST(ClosestPointLaws, TiesPickOneOfTheNearest) {
  // The axis of a cylinder: every point of a circle is nearest. The middle of a cube: six faces.
  const Surface wall = make_cylinder(2.0, 3.0).surface(0);
  const ClosestPoint on_axis = closest_point(wall, Vec3(0, 0, 1.5));
  EXPECT_NEAR(on_axis.distance, 2.0, 1e-14);
  EXPECT_NEAR(on_axis.point.z(), 1.5, 1e-7);
  const ClosestPoint middle = closest_point(testing::make_cube_model(3, 2), Vec3(0.5, 0.5, 0.5));
  EXPECT_NEAR(middle.distance, 0.5, 1e-15);
  // The same answer every time.
  const ClosestPoint again = closest_point(testing::make_cube_model(3, 2), Vec3(0.5, 0.5, 0.5));
  EXPECT_EQ(middle.patch, again.patch);
  EXPECT_EQ(middle.uv, again.uv);
}

TEST(ClosestPointLaws, NearPolesTheSurfaceIsStillMetAtARightAngle) {
  const Surface sphere = make_sphere(1.0).surface(0);
  for (double tilt : {0.0, 1e-8, 1e-4, 0.05}) {
    for (double turn : {0.3, 2.2, 5.9}) {
      for (double radius : {0.4, 0.999999, 7.0}) {
        const Vec3 outward(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn),
                           std::cos(tilt));
        for (double side : {1.0, -1.0}) {
          const ClosestPoint got = closest_point(sphere, side * radius * outward);
          EXPECT_NEAR(got.distance, std::abs(radius - 1.0), 2e-15 * (1.0 + radius));
          EXPECT_LT((got.point - side * outward).norm(), 1e-6) << tilt << ' ' << turn;
        }
      }
    }
  }
}

TEST(ClosestPointLaws, CollapsedSurfacesHaveOneAnswer) {
  const KnotVector line = KnotVector::uniform(1, 1);
  const Vec3 only(1, 2, 3);
  const Surface point(line, line, {only, only, only, only});
  EXPECT_EQ(closest_point(point, Vec3(1, 2, 5)).distance, 2.0);
  EXPECT_EQ(closest_point(point, only).distance, 0.0);
  // A surface folded into a segment: derivatives are parallel everywhere.
  const Surface segment(line, line, {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  const ClosestPoint got = closest_point(segment, Vec3(0.8, 1.0, 0));
  EXPECT_NEAR(got.distance, 1.0, 1e-14);
  EXPECT_NEAR(got.point.x(), 0.8, 1e-7);
}

TEST(ClosestPointLaws, TrimmedResultsAreKeptOrOnTheLoop) {
  std::mt19937 random(343);
  for (int round = 0; round < 6; ++round) {
    const Surface surface = random_surface(random, random_clamped(random, 3, 1, 1),
                                           random_clamped(random, 2, 2, 1), round % 2 == 1);
    TrimRegion trim;
    trim.loops.emplace_back();
    const double u_length = surface.u_knots().end();
    const double v_length = surface.v_knots().end();
    for (int k = 0; k < 60; ++k) {
      const double angle = 2 * M_PI * k / 60;
      const double radius = 0.3 + 0.1 * std::cos(3 * angle);
      trim.loops[0].push_back({u_length * (0.5 + radius * std::cos(angle)),
                               v_length * (0.5 + radius * std::sin(angle))});
    }
    for (int k = 0; k < 6; ++k) {
      const Vec3 p = 1.5 * testing::random_points(random, 1)[0];
      const ClosestPoint got = closest_point(surface, trim, p);
      ASSERT_EQ(got.patch, 0);
      double kept = std::numeric_limits<double>::infinity();
      for (double u : testing::sample_parameters(surface.u_knots(), 12)) {
        for (double v : testing::sample_parameters(surface.v_knots(), 12)) {
          if (inside_trim(trim, u, v)) kept = std::min(kept, (surface.point(u, v) - p).norm());
        }
      }
      EXPECT_LE(got.distance, kept + 1e-14);
      double to_loop = std::numeric_limits<double>::infinity();
      const auto& loop = trim.loops[0];
      for (size_t i = 0; i < loop.size(); ++i) {
        const Eigen::Vector2d a(loop[i].u, loop[i].v);
        const Uv& next = loop[(i + 1) % loop.size()];
        const Eigen::Vector2d along = Eigen::Vector2d(next.u, next.v) - a;
        const Eigen::Vector2d to = Eigen::Vector2d(got.uv.u, got.uv.v) - a;
        const double share = std::clamp(to.dot(along) / along.squaredNorm(), 0.0, 1.0);
        to_loop = std::min(to_loop, (to - share * along).norm());
      }
      EXPECT_TRUE(inside_trim(trim, got.uv.u, got.uv.v) || to_loop < 1e-12) << to_loop;
    }
  }
}

// The sides of a triangle are long: the distance along one has several minima.
TEST(ClosestPointLaws, LongSegmentsOfLoopsAreSearchedWhole) {
  std::mt19937 random(346);
  const KnotVector u = KnotVector::uniform(2, 6);
  const KnotVector v = KnotVector::uniform(2, 2);
  std::vector<Vec3> poles;
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      poles.emplace_back(u.greville(i), v.greville(j), i % 2 == 0 ? 0.3 : -0.3);
    }
  }
  const Surface waves(u, v, poles);
  TrimRegion trim;
  trim.loops = {{{0.02, 0.5}, {0.98, 0.5}, {0.5, 0.95}}};
  for (int k = 0; k < 30; ++k) {
    // In front of the edge v = 0.5, where the kept region begins.
    const Vec3 p(testing::uniform(random, 0.1, 0.9), -0.2, testing::uniform(random, -0.6, 0.6));
    double along = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= 2000; ++i) {
      along = std::min(along, (waves.point(0.02 + 0.96 * i / 2000, 0.5) - p).norm());
    }
    EXPECT_LE(closest_point(waves, trim, p).distance, along + 1e-12) << p.transpose();
  }
}

TEST(ClosestPointLaws, NothingIsLeftWhenEverythingIsTrimmedAway) {
  const PatchModel cube = testing::make_cube_model(2, 2);
  TrimRegion nothing;
  nothing.loops.emplace_back();  // a loop without points encloses nothing
  EXPECT_EQ(closest_point(cube.surface(0), nothing, Vec3(0, 0, 2)).patch, -1);
  PatchModel model = cube;
  for (Patch& patch : model.patches) patch.trim = nothing;
  EXPECT_EQ(closest_point(model, Vec3(0, 0, 2)).patch, -1);
  model.patches[3].trim = {};
  EXPECT_EQ(closest_point(model, Vec3(5, 0, 2)).patch, 3) << "the only face that is left";
}

// Patches are skipped by the boxes of their poles: that must never lose the nearest one.
TEST(ClosestPointLaws, TheModelAgreesWithAllItsPatches) {
  std::mt19937 random(344);
  testing::RandomModelOptions options;
  options.weight_ratio = 3.0;
  options.spans = 2;
  PatchModel model = testing::random_closed_model(345, options);
  testing::translate(model, Vec3(10, -20, 5));
  for (int k = 0; k < 12; ++k) {
    const Vec3 p = Vec3(10.5, -19.5, 5.5) + (k % 3 + 0.5) * testing::random_points(random, 1)[0];
    const ClosestPoint got = closest_point(model, p);
    double best = std::numeric_limits<double>::infinity();
    for (int q = 0; q < 6; ++q) best = std::min(best, closest_point(model.surface(q), p).distance);
    EXPECT_EQ(got.distance, best);
    EXPECT_EQ(got.point, model.surface(got.patch).point(got.uv.u, got.uv.v));
  }
  EXPECT_THROW(closest_point(model.surface(0), Vec3(INFINITY, 0, 0)), PreconditionError);
}

}  // namespace
}  // namespace isochor
