// The laws of smoothness.h on random surfaces, and what locks make of the measures.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/refinement.h"
#include "isochor/bspline/smoothness.h"
#include "support/locks.h"
#include "support/models.h"
#include "support/revolved.h"
#include "support/splines.h"

namespace isochor {
namespace {

double length_of(const KnotVector& knots) { return knots.end() - knots.begin(); }

// A random surface with a knot line of multiplicity equal to the degree at which it bends.
Surface bent(std::mt19937& random, bool rational) {
  const KnotVector u(3, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2});
  return testing::random_surface(random, u, testing::random_clamped(random, 2, 2, 1), rational);
}

Surface mapped(const Surface& surface, const Eigen::Matrix3d& matrix, const Vec3& shift) {
  std::vector<Vec3> poles = surface.poles();
  for (Vec3& p : poles) p = matrix * p + shift;
  return Surface(surface.u_knots(), surface.v_knots(), poles, surface.weights());
}

TEST(SmoothnessLaws, MeasuresFollowMotionsAndScales) {
  std::mt19937 random(381);
  for (const bool rational : {false, true}) {
    const Surface surface = bent(random, rational);
    const auto before = interior_smoothness(surface, Direction::kU, 2.0);
    ASSERT_EQ(before.size(), 1u);
    EXPECT_GT(before[0].max_angle_rad, 0.01);
    const Eigen::AngleAxisd turn(2.0, Vec3(3, -1, 2).normalized());
    for (double scale : {1.0, 1e6, 1e-6}) {
      const Surface moved =
          mapped(surface, scale * turn.toRotationMatrix(), scale * Vec3(4, -8, 1));
      const auto after = interior_smoothness(moved, Direction::kU, 2.0 * scale);
      EXPECT_NEAR(after[0].max_angle_rad, before[0].max_angle_rad, 1e-11);
      EXPECT_NEAR(after[0].max_curvature_jump * scale / before[0].max_curvature_jump, 1.0, 1e-10);
      EXPECT_EQ(after[0].measured, before[0].measured);
    }
  }
}

TEST(SmoothnessLaws, MeasuresDoNotDependOnDomainsOrDirections) {
  std::mt19937 random(382);
  const Surface surface = bent(random, false);
  const auto before = interior_smoothness(surface, Direction::kU, 2.0)[0];
  // Another domain along, another one across.
  std::vector<double> u = surface.u_knots().knots();
  std::vector<double> v = surface.v_knots().knots();
  for (double& t : u) t = 100.0 + 0.01 * t;
  for (double& t : v) t = 50.0 * t - 3.0;
  const Surface stretched(KnotVector(3, u), KnotVector(2, v), surface.poles());
  const auto after = interior_smoothness(stretched, Direction::kU, 2.0)[0];
  EXPECT_NEAR(after.max_angle_rad, before.max_angle_rad, 1e-9);
  EXPECT_NEAR(after.max_curvature_jump / before.max_curvature_jump, 1.0, 1e-9);
  // The same lines as lines of v.
  std::vector<Vec3> poles;
  for (int j = 0; j < surface.v_size(); ++j) {
    for (int i = 0; i < surface.u_size(); ++i) poles.push_back(surface.pole(i, j));
  }
  const Surface swapped(surface.v_knots(), surface.u_knots(), poles);
  const auto other = interior_smoothness(swapped, Direction::kV, 2.0)[0];
  EXPECT_NEAR(other.max_angle_rad, before.max_angle_rad, 1e-12);
  EXPECT_NEAR(other.max_curvature_jump / before.max_curvature_jump, 1.0, 1e-12);
  EXPECT_EQ(other.knot, before.knot);
}

// Law (3): what the basis guarantees is never measured away, and only what it does not guarantee
// is measured at all.
TEST(SmoothnessLaws, NeverRougherThanTheBasis) {
  std::mt19937 random(383);
  for (int degree : {1, 2, 3, 4, 6}) {
    const Surface surface =
        testing::random_surface(random, testing::random_clamped(random, degree, 5),
                                testing::random_unclamped(random, 2, 3), degree % 2 == 0);
    for (Direction direction : {Direction::kU, Direction::kV}) {
      const KnotVector& knots = knots_of(surface, direction);
      const auto lines = interior_smoothness(surface, direction, 2.0);
      ASSERT_EQ(lines.size() + 2, knots.breaks().size());
      for (const KnotLine& line : lines) {
        const int order = knots.degree() - line.multiplicity;
        EXPECT_EQ(line.multiplicity, knots.multiplicity(line.knot));
        EXPECT_EQ(line.guaranteed, order >= 2   ? Smoothness::kCurvature
                                   : order == 1 ? Smoothness::kTangent
                                                : Smoothness::kSharp);
        EXPECT_GE(line.measured, line.guaranteed);
        if (order >= 1) {
          EXPECT_LT(line.max_angle_rad, 1e-7) << degree;
        }
        if (order >= 2) {
          EXPECT_EQ(line.max_curvature_jump, 0.0);
        }
      }
    }
  }
}

TEST(SmoothnessLaws, ClassesAreClosedAtTheirBounds) {
  const double tiny = 1e-9;
  EXPECT_EQ(classify_smoothness(kSmoothAngle, 0.0, 1.0), Smoothness::kCurvature);
  EXPECT_EQ(classify_smoothness(kSmoothAngle * (1 + tiny), 0.0, 1.0), Smoothness::kAlmost);
  EXPECT_EQ(classify_smoothness(kAlmostSmoothAngle, 0.0, 1.0), Smoothness::kAlmost);
  EXPECT_EQ(classify_smoothness(kAlmostSmoothAngle * (1 + tiny), 0.0, 1.0), Smoothness::kSharp);
  EXPECT_EQ(classify_smoothness(0.0, kSameCurvature / 4.0, 4.0), Smoothness::kCurvature);
  EXPECT_EQ(classify_smoothness(0.0, kSameCurvature / 4.0 * (1 + tiny), 4.0), Smoothness::kTangent);
  // Nothing that is not a number counts as smooth.
  EXPECT_EQ(classify_smoothness(std::nan(""), 0.0, 1.0), Smoothness::kSharp);
  EXPECT_EQ(classify_smoothness(0.0, std::nan(""), 1.0), Smoothness::kTangent);
}

TEST(SmoothnessLaws, FramesKnowTheSignOfThePatch) {
  const Surface wall =
      testing::make_revolved(KnotVector::uniform(1, 1), {{2, 0}, {2, 1}}).surface(0);
  const auto at = wall.derivatives(0.7, 0.5, 2);
  const auto frame = [&](bool tangent_is_u, double sign) {
    return curve_frame(at, tangent_is_u, sign, 4.0, length_of(wall.u_knots()),
                       length_of(wall.v_knots()));
  };
  // Along the axis nothing bends; around it with 1 / radius, away from the outward normal.
  EXPECT_NEAR(frame(true, 1.0).curvature, 0.0, 1e-14);
  EXPECT_NEAR(frame(false, 1.0).curvature, -0.5, 1e-14);
  EXPECT_NEAR(frame(false, -1.0).curvature, 0.5, 1e-14);
  EXPECT_LT((frame(false, 1.0).normal + frame(false, -1.0).normal).norm(), 1e-16);
  EXPECT_NEAR(frame(true, 1.0).normal.dot(wall.point(0.7, 0.5)), 2.0, 1e-14);
}

TEST(SmoothnessLaws, PolesOfConesOfAllAngles) {
  // From a needle to a nearly flat disk: the angle between opposite normals is pi - opening.
  for (double half_opening : {0.1, 0.8, 1.5, M_PI / 2 - 0.02, M_PI / 2 - 1e-5}) {
    const double height = std::cos(half_opening) / std::sin(half_opening);
    const Surface cone =
        testing::make_revolved(KnotVector::uniform(1, 1), {{1, 0}, {0, height}}).surface(0);
    const PoleSide pole = pole_side(cone, Side::kVEnd, 3.0);
    ASSERT_TRUE(pole.collapsed);
    EXPECT_NEAR(pole.max_angle_rad, M_PI - 2 * half_opening, 1e-12);
    EXPECT_EQ(pole.smoothness, classify_smoothness(pole.max_angle_rad, 1e9, 1.0));
    EXPECT_FALSE(pole_side(cone, Side::kVBegin, 3.0).collapsed);
    EXPECT_FALSE(pole_side(cone, Side::kUBegin, 3.0).collapsed);
  }
}

TEST(SmoothnessLaws, PolesWithoutDirectionsCountAsWorthProtecting) {
  // The second row is the pole as well: even the directions vanish.
  const KnotVector u = KnotVector::uniform(1, 1);
  const KnotVector v = KnotVector::uniform(2, 1);
  const Surface surface(u, v, {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 1, 0}});
  const PoleSide pole = pole_side(surface, Side::kVBegin, 1.0);
  EXPECT_TRUE(pole.collapsed);
  EXPECT_EQ(pole.smoothness, Smoothness::kAlmost);
  EXPECT_EQ(pole.spread, 0.0);
  // A side that is only nearly a point says by how much; unclamped sides are no poles.
  const Surface near(u, v, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1e-7}, {1, 1, 0}, {0, 1, 0}});
  EXPECT_TRUE(pole_side(near, Side::kVBegin, 1.0).collapsed);
  EXPECT_NEAR(pole_side(near, Side::kVBegin, 1.0).spread, 1e-7, 1e-20);
  EXPECT_FALSE(pole_side(near, Side::kVBegin, 0.01).collapsed);
  const Surface open(u, KnotVector(2, {-2, -1, 0, 1, 2, 3}), near.poles());
  EXPECT_FALSE(pole_side(open, Side::kVBegin, 1.0).collapsed);
}

// Law (1) of continuity.h for knot lines: raise multiplicities at random, derive the locks, move
// what is free, and every line is as smooth as its degree can keep it.
TEST(SmoothnessLaws, LockedKnotLinesStayAsSmoothAsTheyWere) {
  std::mt19937 random(384);
  for (int round = 0; round < 8; ++round) {
    const int degree = 2 + round % 4;
    const KnotVector u = testing::random_clamped(random, degree, 9, 1);
    const KnotVector v = round % 2 == 0 ? testing::random_clamped(random, 3, 6, 1)
                                        : testing::random_unclamped(random, 3, 7);
    const Surface smooth = testing::random_surface(random, u, v, round > 3);
    std::vector<double> more(static_cast<size_t>(degree) - 1, u.interior()[2]);
    more.push_back(u.interior()[6]);
    if (degree == 2) more.resize(1);
    const Surface surface = refine(smooth, with_knots(u, more), with_knots(v, {v.interior()[3]}));
    PatchModel model = testing::make_separate_model({surface});
    derive_locks(model, {});
    const std::set<int> locked = testing::locked_points(model);
    const auto at = testing::shaken(model, 0.2);
    EXPECT_LT(locked.size(), at.size());
    EXPECT_GT(locked.size(), 0u) << round;
    const double size = diagonal(model);
    for (Direction direction : {Direction::kU, Direction::kV}) {
      const int order = knots_of(surface, direction).degree();
      const auto before = interior_smoothness(surface, direction, size);
      const auto after = interior_smoothness(model.surface(0, at), direction, size);
      for (size_t k = 0; k < before.size(); ++k) {
        const Smoothness kept =
            order == 2 ? std::min(before[k].measured, Smoothness::kTangent) : before[k].measured;
        EXPECT_GE(after[k].measured, kept)
            << round << " at " << before[k].knot << ' ' << after[k].max_angle_rad << ' '
            << after[k].max_curvature_jump;
      }
    }
  }
}

}  // namespace
}  // namespace isochor
