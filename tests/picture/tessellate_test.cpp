#include "isochor/picture/tessellate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/refinement.h"
#include "support/models.h"

namespace isochor {
namespace {

constexpr double kPi = 3.14159265358979323846;

TessellationOptions with_chord(double chord) {
  TessellationOptions options;
  options.chord = chord;
  options.min_cells = 1;
  return options;
}

// How often each undirected edge of positions (equal to 1e-9) is used; closed means always twice.
bool watertight(const Mesh& mesh) {
  std::map<std::array<long long, 3>, int> ids;
  const auto id = [&](int i) {
    const Vec3& p = mesh.positions[static_cast<size_t>(i)];
    const std::array<long long, 3> key = {std::llround(p.x() * 1e9), std::llround(p.y() * 1e9),
                                          std::llround(p.z() * 1e9)};
    return ids.try_emplace(key, static_cast<int>(ids.size())).first->second;
  };
  std::map<std::pair<int, int>, int> balance;
  for (const auto& t : mesh.triangles) {
    const int c[3] = {id(t[0]), id(t[1]), id(t[2])};
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;  // at a pole
    for (int k = 0; k < 3; ++k) {
      const int a = c[k], b = c[(k + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  for (const auto& [edge, sum] : balance) {
    if (sum != 0) return false;
  }
  return !balance.empty();
}

TEST(Tessellator, CubeHasItsAreaVolumeAndNormals) {
  for (bool reversed : {false, true}) {
    PatchModel cube = testing::make_cube_model(3, 4);
    if (reversed) {
      for (Patch& patch : cube.patches) patch.reversed = true;
    }
    const Mesh mesh = tessellate(cube);
    EXPECT_NO_THROW(require_usable(mesh));
    EXPECT_NEAR(area(mesh), 6.0, 1e-13);
    EXPECT_NEAR(enclosed_volume(mesh), reversed ? -1.0 : 1.0, 1e-13);
    EXPECT_TRUE(watertight(mesh));
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      const double outwards = mesh.normals[i].dot(mesh.positions[i] - Vec3::Constant(0.5));
      EXPECT_NEAR(reversed ? -outwards : outwards, 0.5, 1e-13);
    }
  }
}

TEST(Tessellator, SphereConvergesToItsAreaWithTheChord) {
  const PatchModel sphere = testing::make_sphere(2.0);
  const double exact = 16.0 * kPi;
  double last = 1e300;
  for (double chord : {1e-2, 1e-3, 1e-4}) {
    const double error = exact - area(tessellate(sphere, with_chord(chord)));
    EXPECT_GT(error, 0.0) << "inscribed";
    EXPECT_LT(error, 40.0 * chord * exact);
    EXPECT_LT(error, 0.25 * last);
    last = error;
  }
}

TEST(Tessellator, NormalsAreRightAlsoAtPoles) {
  const Mesh mesh = tessellate(testing::make_sphere(2.0));
  int poles = 0;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3& p = mesh.positions[i];
    EXPECT_NEAR(p.norm(), 2.0, 1e-14);
    EXPECT_LT((mesh.normals[i] - p / 2.0).norm(), 1e-3) << p.transpose();
    if (std::hypot(p.x(), p.y()) < 1e-12) ++poles;
  }
  EXPECT_GT(poles, 10) << "the collapsed rows";
}

TEST(Tessellator, ChordBoundHolds) {
  const double chord = 1e-3;
  const PatchModel cylinder = testing::make_cylinder(1.0, 2.0);
  const Mesh mesh = tessellate(cylinder, with_chord(chord));
  const double bound = 1.5 * chord * diagonal(cylinder);
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vec3& a = mesh.positions[static_cast<size_t>(t[static_cast<size_t>(k)])];
      const Vec3& b = mesh.positions[static_cast<size_t>(t[static_cast<size_t>((k + 1) % 3)])];
      const double ra = std::hypot(a.x(), a.y()), rb = std::hypot(b.x(), b.y());
      if (ra < 0.999 || rb < 0.999) continue;
      const Vec3 middle = 0.5 * (a + b);
      EXPECT_LT(1.0 - std::hypot(middle.x(), middle.y()), bound);
    }
  }
}

TEST(Tessellator, MatchingJoinsMeetWithoutCracks) {
  // Only the top is bent, so that its neighbours must take over its finer cells.
  PatchModel cube = testing::make_cube_model(3, 3);
  for (Vec3& p : cube.points) {
    if (p.z() == 1.0) p.z() += 0.3 * std::sin(5.0 * p.x()) * std::sin(4.0 * p.y());
  }
  EXPECT_FALSE(watertight(tessellate(cube))) << "without joins nothing is matched";
  cube.joins = find_joins(cube);
  EXPECT_TRUE(watertight(tessellate(cube)));
}

TEST(Tessellator, MeshesBeforeAndAfterCorrespond) {
  const PatchModel model = testing::random_closed_model(11);
  std::vector<Vec3> moved = model.points;
  for (Vec3& p : moved) p += Vec3(0.5, -0.25, 2.0);
  const Tessellator cut(model, {}, {moved});
  const Mesh before = cut.mesh();
  const Mesh after = cut.mesh(moved);
  EXPECT_EQ(before.triangles, after.triangles);
  EXPECT_EQ(before.groups, after.groups);
  for (size_t i = 0; i < before.positions.size(); ++i) {
    EXPECT_LT((after.positions[i] - before.positions[i] - Vec3(0.5, -0.25, 2.0)).norm(), 1e-14);
  }
}

TEST(Tessellator, OtherPointsMakeCellsFiner) {
  const PatchModel cube = testing::make_cube_model(3, 2);
  std::vector<Vec3> bent = cube.points;
  for (Vec3& p : bent) p.z() += p.z() == 1.0 ? p.x() * p.x() * p.x() : 0.0;
  EXPECT_GT(Tessellator(cube, {}, {bent}).mesh().triangles.size(),
            2 * Tessellator(cube).mesh().triangles.size());
}

TEST(Tessellator, OneCutServesARefinedModel) {
  const PatchModel model = testing::random_closed_model(12);
  const Tessellator cut(model);
  std::vector<Surface> refined;
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const Surface surface = model.surface(q);
    const double middle = 0.5 * (surface.u_knots().begin() + surface.u_knots().end());
    refined.push_back(refine(surface, with_knots(surface.u_knots(), {middle}), surface.v_knots()));
  }
  const Mesh a = cut.mesh(), b = cut.mesh(refined);
  ASSERT_EQ(a.triangles, b.triangles);
  for (size_t i = 0; i < a.positions.size(); ++i) {
    EXPECT_LT((a.positions[i] - b.positions[i]).norm(), 1e-13);
  }
  const std::vector<LineSet> c = cut.borders(), d = cut.borders(refined);
  ASSERT_EQ(c[0].segments, d[0].segments);
  for (size_t i = 0; i < c[0].points.size(); ++i) {
    EXPECT_LT((c[0].points[i] - d[0].points[i]).norm(), 1e-13);
  }
  refined.pop_back();
  EXPECT_THROW(cut.mesh(refined), PreconditionError);
}

TEST(Tessellator, CreasesHaveANormalForEitherSide) {
  // A polyline profile: degree 1, a right angle at u = 1/2.
  PatchModel model;
  Patch patch{"", "face:1", KnotVector::uniform(1, 2), KnotVector::uniform(1, 1), {}, {}, false,
              {}, {}};
  for (const Vec3& p :
       {Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 0, 1), Vec3(1, 1, 1)}) {
    patch.points.push_back(static_cast<int>(model.points.size()));
    model.points.push_back(p);
  }
  model.patches.push_back(patch);
  const Mesh mesh = tessellate(model);
  int flat = 0, upright = 0;
  for (const Vec3& n : mesh.normals) {
    flat += n.isApprox(Vec3(0, 0, 1), 1e-12);
    upright += n.isApprox(Vec3(-1, 0, 0), 1e-12);
  }
  EXPECT_EQ(flat + upright, static_cast<int>(mesh.normals.size()));
  EXPECT_EQ(flat, upright);
}

TEST(Tessellator, ManyTrianglesAreBounded) {
  TessellationOptions options;
  options.chord = 1e-9;
  options.max_triangles = 5000;
  const size_t count = tessellate(testing::make_sphere(1.0), options).triangles.size();
  EXPECT_LE(count, 5000u);
  EXPECT_GT(count, 2000u);
}

TEST(Tessellator, BadOptionsAreRefused) {
  const PatchModel cube = testing::make_cube_model(2, 1);
  TessellationOptions options;
  options.chord = 0.0;
  EXPECT_THROW(tessellate(cube, options), PreconditionError);
  options = {};
  options.min_cells = 0;
  EXPECT_THROW(tessellate(cube, options), PreconditionError);
  options = {};
  options.trim_levels = 20;
  EXPECT_THROW(tessellate(cube, options), PreconditionError);
  EXPECT_THROW(Tessellator(cube).mesh(std::vector<Vec3>(3)), PreconditionError);
}

TEST(Tessellator, BordersFollowTheEdgesAndKnowSmoothJoins) {
  PatchModel cube = testing::make_cube_model(3, 2);
  cube.joins = find_joins(cube);
  std::vector<LineSet> lines = Tessellator(cube).borders();
  double length = 0.0;
  for (const auto& s : lines[0].segments) {
    length +=
        (lines[0].points[static_cast<size_t>(s[0])] - lines[0].points[static_cast<size_t>(s[1])])
            .norm();
  }
  EXPECT_NEAR(length, 24.0, 1e-12) << "each of the 12 edges from both sides";
  EXPECT_TRUE(lines[1].empty());
  for (Join& join : cube.joins) join.smoothness = Smoothness::kTangent;
  lines = Tessellator(cube).borders();
  EXPECT_TRUE(lines[0].empty());
  EXPECT_FALSE(lines[1].empty());
}

TEST(Tessellator, CollapsedSidesGiveNoBorder) {
  for (const LineSet& lines : Tessellator(testing::make_sphere(1.0)).borders()) {
    for (const auto& s : lines.segments) {
      EXPECT_GT((lines.points[static_cast<size_t>(s[0])] - lines.points[static_cast<size_t>(s[1])])
                    .norm(),
                1e-6);
    }
  }
}

TEST(ControlNet, HasAllLegs) {
  const PatchModel cube = testing::make_cube_model(3, 2);  // 5 x 5 points a face
  EXPECT_EQ(control_net(cube, cube.points).segments.size(), 6u * 2u * 5u * 4u);
}

}  // namespace
}  // namespace isochor
