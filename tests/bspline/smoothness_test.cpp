#include "isochor/bspline/smoothness.h"

#include <gtest/gtest.h>

#include <cmath>

#include "isochor/bspline/refinement.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::make_periodic_torus;
using ::isochor::testing::make_sphere;

CurveFrame frame_at(const Surface& surface, double u, double v, bool tangent_is_u, double size) {
  return curve_frame(surface.derivatives(u, v, 2), tangent_is_u, 1.0, size,
                     surface.u_knots().end() - surface.u_knots().begin(),
                     surface.v_knots().end() - surface.v_knots().begin());
}

TEST(Smoothness, CurvatureOfASphereIsItsRadius) {
  for (double radius : {1.0, 3.0, 1e9, 1e-9}) {
    const PatchModel model = make_sphere(radius);
    const Surface surface = model.surface(0);
    const double size = diagonal(model);
    for (double s : {0.11, 0.4, 0.83}) {
      for (bool tangent_is_u : {true, false}) {
        const double u =
            surface.u_knots().begin() + s * (surface.u_knots().end() - surface.u_knots().begin());
        const double v = surface.v_knots().begin() +
                         (1 - s) * (surface.v_knots().end() - surface.v_knots().begin());
        const CurveFrame frame = frame_at(surface, u, v, tangent_is_u, size);
        ASSERT_TRUE(frame.regular);
        EXPECT_NEAR(std::abs(frame.curvature) * radius, 1.0, 1e-12);
        const Vec3 p = surface.point(u, v) / radius;
        EXPECT_LT(frame.normal.cross(p).norm(), 1e-13);
      }
    }
  }
}

// The graph z = x^2 y + 3 y^2 over the unit square, as a Bezier patch found by interpolation of the
// monomials: curvatures come from the textbook formula for graphs.
TEST(Smoothness, CurvatureAcrossAgreesWithTheFormulaForGraphs) {
  const KnotVector quadratic = KnotVector::uniform(2, 1);
  std::vector<Vec3> poles;
  const double x2[] = {0, 0, 1};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      poles.emplace_back(i / 2.0, j / 2.0, x2[i] * (j / 2.0) + 3.0 * x2[j]);
    }
  }
  const Surface surface(quadratic, quadratic, poles);
  for (double x : {0.1, 0.6}) {
    for (double y : {0.2, 0.9}) {
      const double zx = 2 * x * y;
      const double zy = x * x + 6 * y;
      const double w2 = 1 + zx * zx + zy * zy;
      // Direction across the curve y = const: perpendicular to (1, 0, zx) in the tangent plane.
      const double a = -zx * zy / (1 + zx * zx);
      const double length2 = a * a + 1 + (a * zx + zy) * (a * zx + zy);
      const double expected = (a * a * 2 * y + 2 * a * 2 * x + 6) / std::sqrt(w2) / length2;
      const CurveFrame frame = frame_at(surface, x, y, true, 3.0);
      EXPECT_NEAR(frame.curvature, expected, 1e-13);
    }
  }
}

TEST(Smoothness, AngleIsAccurateNearZero) {
  const Vec3 a(1, 0, 0);
  EXPECT_NEAR(angle_between(a, Vec3(std::cos(1e-9), std::sin(1e-9), 0)), 1e-9, 1e-24);
  EXPECT_EQ(angle_between(a, a), 0.0);
  EXPECT_NEAR(angle_between(a, -a), M_PI, 1e-15);
}

TEST(Smoothness, DoubleKnotsOfACircleAreCurvatureContinuous) {
  const PatchModel model = make_sphere(2.0);
  const Surface surface = model.surface(0);
  const auto lines = interior_smoothness(surface, Direction::kU, diagonal(model));
  ASSERT_FALSE(lines.empty());
  for (const KnotLine& line : lines) {
    EXPECT_EQ(line.multiplicity, 2);
    EXPECT_EQ(line.guaranteed, Smoothness::kSharp);
    EXPECT_EQ(line.measured, Smoothness::kCurvature)
        << line.max_angle_rad << ' ' << line.max_curvature_jump;
  }
}

TEST(Smoothness, InsertedMultiplicityDoesNotHideTheMeasuredSmoothness) {
  // A random cubic with simple knots is C2; raising a multiplicity keeps the geometry.
  std::mt19937 random(31);
  const KnotVector u = testing::random_clamped(random, 3, 3, 1);
  const KnotVector v = testing::random_clamped(random, 3, 2, 1);
  const Surface smooth = testing::random_surface(random, u, v, false);
  const double knot = u.interior().front();
  const Surface rough = refine(smooth, with_knots(u, {knot, knot}), v);
  const auto lines = interior_smoothness(rough, Direction::kU, 3.0);
  EXPECT_EQ(lines.front().guaranteed, Smoothness::kSharp);
  EXPECT_EQ(lines.front().measured, Smoothness::kCurvature);
  EXPECT_EQ(lines.back().guaranteed, Smoothness::kCurvature);

  // One pole of the line moved: a crease of the size of the move.
  std::vector<Vec3> poles = rough.poles();
  int row = 0;
  while (rough.u_knots()[row + 1] < knot) ++row;
  poles[rough.index(row, 2)] += Vec3(0.3, -0.2, 0.4);
  const Surface creased(rough.u_knots(), rough.v_knots(), poles);
  const auto after = interior_smoothness(creased, Direction::kU, 3.0);
  EXPECT_EQ(after.front().measured, Smoothness::kSharp);
  EXPECT_GT(after.front().max_angle_rad, 0.05);
}

// A strip bent at x = 0 by `angle`, of two bilinear patches in one surface (degree 1, one knot).
TEST(Smoothness, BendAnglesAreClassified) {
  const KnotVector u = KnotVector::clamped(1, {-1.0, 0.0, 1.0});
  const KnotVector v = KnotVector::uniform(1, 1);
  for (const auto& [angle, expected] :
       {std::pair{0.5e-4, Smoothness::kCurvature}, std::pair{0.01, Smoothness::kAlmost},
        std::pair{0.2, Smoothness::kSharp}}) {
    std::vector<Vec3> poles;
    for (double x : {-1.0, 0.0, 1.0}) {
      for (double y : {0.0, 1.0}) {
        poles.emplace_back(x > 0 ? std::cos(angle) : x, y, x > 0 ? std::sin(angle) : 0.0);
      }
    }
    const auto lines = interior_smoothness(Surface(u, v, poles), Direction::kU, 2.0);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_NEAR(lines[0].max_angle_rad, angle, 1e-12);
    EXPECT_EQ(lines[0].measured, expected) << angle;
  }
}

TEST(Smoothness, PolesOfASphereHaveATangentPlaneATipHasNone) {
  const PatchModel model = make_sphere(1.5);
  const Surface sphere = model.surface(0);
  int poles = 0;
  for (Side side : kSides) {
    const PoleSide pole = pole_side(sphere, side, diagonal(model));
    if (!pole.collapsed) continue;
    ++poles;
    EXPECT_EQ(pole.smoothness, Smoothness::kTangent) << pole.max_angle_rad;
  }
  EXPECT_EQ(poles, 2);

  // A cone: the v0 side collapsed, straight generators.
  const KnotVector u = sphere.u_knots();
  const KnotVector v = KnotVector::uniform(1, 1);
  std::vector<Vec3> points;
  std::vector<double> weights;
  for (int i = 0; i < sphere.u_size(); ++i) {
    const Vec3 rim = sphere.pole(i, 2);
    points.emplace_back(0, 0, 4);
    points.push_back(rim);
    for (int k = 0; k < 2; ++k) weights.push_back(sphere.weights()[sphere.index(i, 2)]);
  }
  const PoleSide tip = pole_side(Surface(u, v, points, weights), Side::kVBegin, 4.0);
  EXPECT_TRUE(tip.collapsed);
  EXPECT_EQ(tip.smoothness, Smoothness::kSharp);
  EXPECT_FALSE(pole_side(Surface(u, v, points, weights), Side::kVEnd, 4.0).collapsed);
}

TEST(Smoothness, SingularPointsAreNotMeasured) {
  const PatchModel model = make_sphere(1.0);
  const Surface surface = model.surface(0);
  for (Side side : kSides) {
    if (!pole_side(surface, side, 2.0).collapsed) continue;
    const KnotVector& across = knots_of(surface, across_direction(side));
    const double t = is_begin_side(side) ? across.begin() : across.end();
    const bool v_side = !is_u_side(side);
    EXPECT_FALSE(frame_at(surface, v_side ? 0.3 : t, v_side ? t : 0.3, true, 3.0).regular);
  }
}

}  // namespace
}  // namespace isochor
