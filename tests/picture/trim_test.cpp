// Trimmed patches: what is kept, and how well the mesh follows the loops.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "isochor/picture/patch_grid.h"
#include "isochor/picture/tessellate.h"
#include "isochor/picture/trim_test.h"

namespace isochor {
namespace {

using internal::TrimTest;

constexpr double kPi = 3.14159265358979323846;
const std::vector<Uv> kBorder = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

std::vector<Uv> circle(double u, double v, double radius, int corners) {
  std::vector<Uv> loop;
  for (int k = 0; k < corners; ++k) {
    const double angle = -2.0 * kPi * k / corners;
    loop.push_back({u + radius * std::cos(angle), v + radius * std::sin(angle)});
  }
  return loop;
}

// The unit square in the plane z = 0 with the identity as parametrisation.
PatchModel square(std::vector<std::vector<Uv>> loops) {
  PatchModel model;
  const KnotVector knots = KnotVector::uniform(2, 5);
  Patch patch{"", "face:1", knots, knots, {}, {}, false, {}, {}};
  for (int i = 0; i < knots.size(); ++i) {
    for (int j = 0; j < knots.size(); ++j) {
      patch.points.push_back(static_cast<int>(model.points.size()));
      model.points.emplace_back(knots.greville(i), knots.greville(j), 0.0);
    }
  }
  patch.trim.loops = std::move(loops);
  model.patches.push_back(patch);
  return model;
}

double area_at_level(const PatchModel& model, int level) {
  TessellationOptions options;
  options.trim_levels = level;
  return area(tessellate(model, options));
}

TEST(TrimTest, InsideIsAnOddNumberOfCrossings) {
  TrimRegion trim;
  trim.loops = {kBorder, circle(0.5, 0.5, 0.25, 64), circle(0.5, 0.5, 0.1, 64)};
  const TrimTest test(trim, {0, 1, 0, 1});
  EXPECT_TRUE(test.inside(0.1, 0.1));
  EXPECT_FALSE(test.inside(0.5, 0.3)) << "in the ring";
  EXPECT_TRUE(test.inside(0.5, 0.5)) << "the island inside the hole";
  EXPECT_TRUE(test.inside(0.0, 0.0)) << "corners of the domain count as just inside";
  EXPECT_TRUE(test.inside(1.0, 1.0));
}

TEST(TrimTest, NoLoopsKeepEverything) {
  const TrimTest test({}, {0, 1, 0, 1});
  EXPECT_TRUE(test.keeps_all());
  EXPECT_TRUE(test.inside(0.3, 0.9));
  EXPECT_FALSE(test.crosses({0, 1, 0, 1}));
}

TEST(TrimTest, BoxesAreCrossedOnlyInTheirInside) {
  TrimRegion trim;
  trim.loops = {{{0.25, 0.25}, {0.75, 0.25}, {0.75, 0.75}, {0.25, 0.75}}};
  const TrimTest test(trim, {0, 1, 0, 1});
  EXPECT_TRUE(test.crosses({0.2, 0.3, 0.4, 0.5}));
  EXPECT_FALSE(test.crosses({0.25, 0.5, 0.25, 0.5})) << "the loop runs along two of its sides";
  EXPECT_FALSE(test.crosses({0.4, 0.6, 0.4, 0.6})) << "the loop is all round";
  EXPECT_FALSE(test.crosses({0.8, 0.9, 0.0, 1.0}));
}

TEST(TrimTest, ADiagonalPassingACornerOutsideIsNoCrossing) {
  TrimRegion trim;
  trim.loops = {{{0.0, 0.6}, {0.6, 0.0}, {1.0, 1.0}}};
  const TrimTest test(trim, {0, 1, 0, 1});
  EXPECT_FALSE(test.crosses({0.0, 0.25, 0.0, 0.25})) << "inside the segment's box, but below it";
  EXPECT_TRUE(test.crosses({0.25, 0.5, 0.25, 0.5}));
}

TEST(TrimmedMesh, LoopsAlongGridLinesAreExact) {
  // A window on knot lines: 0.2 .. 0.6 in u, 0.4 .. 0.8 in v.
  const PatchModel model = square({kBorder, {{0.2, 0.4}, {0.2, 0.8}, {0.6, 0.8}, {0.6, 0.4}}});
  EXPECT_NEAR(area_at_level(model, 0), 1.0 - 0.16, 1e-5);
}

TEST(TrimmedMesh, HolesHaveTheRightAreaAndTheErrorFallsWithTheLevel) {
  const PatchModel model = square({kBorder, circle(0.47, 0.52, 0.283, 720)});
  const double exact =
      1.0 - 0.5 * 720 * 0.283 * 0.283 * std::sin(2.0 * kPi / 720);  // of the polygon
  const double coarse = std::abs(area_at_level(model, 1) - exact);
  const double fine = std::abs(area_at_level(model, 3) - exact);
  const double finest = std::abs(area_at_level(model, 5) - exact);
  EXPECT_LT(coarse, 1e-2);
  EXPECT_LT(fine, coarse / 6.0) << "second order in the size of the cells";
  EXPECT_LT(finest, fine / 6.0);
  EXPECT_LT(finest, 2e-5);
}

TEST(TrimmedMesh, AnOuterLoopThatIsNotTheBorderLeavesTheRestOut) {
  const PatchModel model = square({circle(0.5, 0.5, 0.4, 360)});
  const double exact = 0.5 * 360 * 0.16 * std::sin(2.0 * kPi / 360);
  EXPECT_NEAR(area_at_level(model, 4), exact, 2e-4);
}

TEST(TrimmedMesh, HasNoCracksBetweenCellsOfDifferentSize) {
  // In the plane a crack has no width; so the edges are counted: an edge used once must lie on the
  // border or on the loop.
  const PatchModel model = square({kBorder, circle(0.5, 0.5, 0.29, 720)});
  TessellationOptions options;
  options.trim_levels = 3;
  const Mesh mesh = tessellate(model, options);
  std::map<std::pair<int, int>, int> uses;
  for (const auto& t : mesh.triangles) {
    for (size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      ++uses[{std::min(a, b), std::max(a, b)}];
    }
  }
  int open = 0;
  for (const auto& [edge, count] : uses) {
    ASSERT_LE(count, 2);
    if (count == 2) continue;
    ++open;
    for (int i : {edge.first, edge.second}) {
      const Vec3& p = mesh.positions[static_cast<size_t>(i)];
      const bool border = std::min({p.x(), p.y(), 1.0 - p.x(), 1.0 - p.y()}) < 1e-12;
      const double off = std::abs(std::hypot(p.x() - 0.5, p.y() - 0.5) - 0.29);
      EXPECT_TRUE(border || off < 1e-4) << p.transpose();
    }
  }
  EXPECT_GT(open, 40);
}

TEST(TrimmedMesh, NormalsAndOrientationStayOutward) {
  PatchModel model = square({kBorder, circle(0.5, 0.5, 0.3, 90)});
  for (bool reversed : {false, true}) {
    model.patches[0].reversed = reversed;
    const Mesh mesh = tessellate(model);
    const double z = reversed ? -1.0 : 1.0;
    for (const Vec3& n : mesh.normals) EXPECT_NEAR(n.z(), z, 1e-12);
    for (const auto& t : mesh.triangles) {
      const Vec3& a = mesh.positions[static_cast<size_t>(t[0])];
      const Vec3 e1 = mesh.positions[static_cast<size_t>(t[1])] - a;
      const Vec3 e2 = mesh.positions[static_cast<size_t>(t[2])] - a;
      EXPECT_GE(e1.cross(e2).z() * z, -1e-15);
    }
  }
}

TEST(TrimmedMesh, BordersAreTheLoops) {
  const PatchModel model = square({kBorder, circle(0.5, 0.5, 0.3, 90)});
  const std::vector<LineSet> lines = Tessellator(model).borders();
  double length = 0.0;
  for (const auto& s : lines[0].segments) {
    length +=
        (lines[0].points[static_cast<size_t>(s[0])] - lines[0].points[static_cast<size_t>(s[1])])
            .norm();
  }
  EXPECT_NEAR(length, 4.0 + 90 * 2.0 * 0.3 * std::sin(kPi / 90), 1e-9);
  EXPECT_TRUE(lines[1].empty());
}

TEST(TrimmedMesh, KnotLinesStopAtHoles) {
  const PatchModel model = square({kBorder, circle(0.5, 0.5, 0.35, 90)});
  const LineSet lines = Tessellator(model).knot_lines(model.points);
  EXPECT_FALSE(lines.empty());
  for (const Vec3& p : lines.points) EXPECT_GT(std::hypot(p.x() - 0.5, p.y() - 0.5), 0.349);
}

}  // namespace
}  // namespace isochor
