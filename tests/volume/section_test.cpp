// Cross sections whose area is known, and the laws of section.h.
#include "isochor/volume/section.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "isochor/base/error.h"
#include "isochor/bspline/model_refinement.h"
#include "isochor/volume/gauss.h"
#include "isochor/volume/section_cells.h"
#include "isochor/volume/volume_form.h"
#include "support/models.h"
#include "support/revolved.h"

namespace isochor {
namespace {

const double kPi = std::acos(-1.0);

Eigen::Matrix3d turned() {
  return Eigen::AngleAxisd(0.9, Vec3(2, -1, 0.4).normalized()).toRotationMatrix();
}

// The area and centroid within bounds that are small.
void expect_section(const PatchModel& model, const Vec3& n, double h, double area,
                    const Vec3& centroid, double share = 1e-12) {
  const Section got = section(model, n, h);
  EXPECT_NEAR(got.area, area, got.bound + 1e-14 * area) << n.transpose() << ' ' << h;
  EXPECT_NEAR(got.area, area, share * area);
  EXPECT_LT(got.bound, 100 * share * area);
  EXPECT_LE((got.centroid - centroid).norm(), got.centroid_bound + 1e-14);
  EXPECT_LT((got.centroid - centroid).norm(), 10 * share * diagonal(model));
  EXPECT_FALSE(got.coplanar);
}

TEST(Section, OfTheUnitCube) {
  for (const auto& [degree, spans] : {std::pair{1, 1}, std::pair{2, 3}, std::pair{3, 12}}) {
    const PatchModel cube = testing::make_cube_model(degree, spans);
    expect_section(cube, Vec3(0, 0, 1), 0.3, 1.0, Vec3(0.5, 0.5, 0.3));
    expect_section(cube, Vec3(0, 2, 0), 0.5, 1.0, Vec3(0.5, 0.25, 0.5));
    // A hexagon, a triangle, and a rectangle through two edges.
    expect_section(cube, Vec3(1, 1, 1), 1.5, 0.75 * std::sqrt(3.0), Vec3(0.5, 0.5, 0.5));
    expect_section(cube, Vec3(1, 1, 1), 0.5, 0.125 * std::sqrt(3.0), Vec3::Constant(0.5 / 3));
    expect_section(cube, Vec3(1, -1, 0), 0.0, std::sqrt(2.0), Vec3(0.5, 0.5, 0.5));
    EXPECT_EQ(section(cube, Vec3(1, 1, 1), -0.1).area, 0.0);
    const Section past = section(cube, Vec3(1, 1, 1), 3.1);
    EXPECT_LE(std::abs(past.area), past.bound);
    EXPECT_LT(past.bound, 1e-13);
    EXPECT_EQ(past.centroid_bound, std::numeric_limits<double>::infinity());
  }
}

TEST(Section, InThePlaneOfAFaceIsTheLimitFromBelow) {
  const PatchModel cube = testing::make_cube_model(2, 2);
  const Section top = section(cube, Vec3(0, 0, 1), 1.0);
  EXPECT_NEAR(top.area, 1.0, 1e-14);
  EXPECT_TRUE(top.coplanar);
  const Section bottom = section(cube, Vec3(0, 0, 1), 0.0);
  EXPECT_EQ(bottom.area, 0.0);
  EXPECT_TRUE(bottom.coplanar);
}

TEST(Section, OfRoundBodies) {
  PatchModel ball = testing::make_sphere(2.0);
  for (const Vec3& n : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(1, 2, -0.5)}) {
    for (double h : {-1.5, 0.0, 0.4, 1.9}) {
      const Vec3 unit = n.normalized();
      expect_section(ball, unit, h, kPi * (4 - h * h), h * unit);
    }
  }
  testing::translate(ball, Vec3(0, 100, 0));
  expect_section(ball, Vec3(0, 1, 0), 101.0, kPi * 3, Vec3(0, 101, 0), 1e-11);
  // A cylinder cut across, along, and aslant.
  const PatchModel cylinder = testing::make_cylinder(1.0, 6.0);
  expect_section(cylinder, Vec3(0, 0, 1), 2.0, kPi, Vec3(0, 0, 2));
  expect_section(cylinder, Vec3(1, 0, 0), 0.5, 12 * std::sqrt(0.75), Vec3(0.5, 0, 3));
  const Vec3 slanted = Vec3(0.6, 0, 0.8);
  expect_section(cylinder, slanted, 2.4, kPi / 0.8, Vec3(0, 0, 3));
}

TEST(Section, OfATorus) {
  const PatchModel torus = testing::make_rational_torus(3.0, 1.0);
  expect_section(torus, Vec3(0, 0, 1), 0.0, kPi * (16 - 4), Vec3::Zero());
  expect_section(torus, Vec3(0, 0, 1), 0.6, kPi * 4 * 3 * 0.8, Vec3(0, 0, 0.6));
  expect_section(torus, Vec3(0, 1, 0), 0.0, 2 * kPi, Vec3::Zero());
  // Tangent on both sides: two circles of the major radius whose centres are two minor radii apart;
  // the section is what belongs to exactly one of them.
  const Section villarceau = section(torus, Vec3(1, 0, std::sqrt(8.0)), 0.0);
  const double lens = 2 * 9 * std::acos(1.0 / 3) - 2 * std::sqrt(8.0);
  const double area = 2 * (9 * kPi - lens);
  EXPECT_NEAR(villarceau.area, area, villarceau.bound + 1e-13);
  EXPECT_LT(villarceau.bound, 1e-3 * area);
}

TEST(Section, TurnsWithTheBody) {
  testing::RandomModelOptions options;
  for (const double ratio : {1.0, 3.0}) {
    options.weight_ratio = ratio;
    PatchModel model = testing::random_closed_model(521, options);
    const Vec3 n = Vec3(0.3, 1, -0.4).normalized();
    const Section before = section(model, n, 0.25);
    EXPECT_GT(before.area, 0.1);
    EXPECT_LT(before.bound, 1e-11);
    const Section other = section(model, -n, -0.25);
    EXPECT_NEAR(other.area, before.area, before.bound + other.bound);
    for (Patch& patch : model.patches) patch.reversed = !patch.reversed;
    EXPECT_EQ(section(model, n, 0.25).area, -before.area);
    for (Patch& patch : model.patches) patch.reversed = !patch.reversed;
    testing::transform(model, turned());
    testing::translate(model, Vec3(3, 4, 5));
    const Section after = section(model, turned() * n, 0.25 + (turned() * n).dot(Vec3(3, 4, 5)));
    EXPECT_NEAR(after.area, before.area, before.bound + after.bound + 1e-14);
    EXPECT_LT((after.centroid - turned() * before.centroid - Vec3(3, 4, 5)).norm(), 1e-12);
  }
}

KnotVector with_knot(const KnotVector& knots, double at) {
  std::vector<double> all = knots.knots();
  all.insert(std::upper_bound(all.begin(), all.end(), at), at);
  return KnotVector(knots.degree(), all);
}

TEST(Section, RefinementChangesNothing) {
  testing::RandomModelOptions options;
  options.spans = 2;
  options.weight_ratio = 2.0;
  const PatchModel model = testing::random_closed_model(523, options);
  PatchModel finer = model;
  for (int q = 0; q < 6; ++q) {
    const Patch& patch = finer.patches[static_cast<size_t>(q)];
    finer = refine(finer, q, with_knot(patch.u_knots, 0.37), with_knot(patch.v_knots, 0.61));
  }
  EXPECT_GT(finer.points.size(), model.points.size());
  for (double h : {0.2, 0.5, 0.9}) {
    const Section a = section(model, Vec3(1, 0.2, 0.1), h);
    const Section b = section(finer, Vec3(1, 0.2, 0.1), h);
    EXPECT_NEAR(a.area, b.area, a.bound + b.bound);
    EXPECT_LT((a.centroid - b.centroid).norm(), a.centroid_bound + b.centroid_bound);
    EXPECT_LT(a.bound, 1e-10);
  }
}

// The integral of the area over all heights is the volume.
TEST(Section, Cavalieri) {
  testing::RandomModelOptions options;
  options.degrees[0] = 2;
  options.bend = 0.1;
  const PatchModel model = testing::random_closed_model(522, options);
  const double volume = VolumeForm(model).value(model.points);
  const Vec3 n(0, 0, 1);
  double low = 0.0;
  double high = 0.0;
  for (const Vec3& p : model.points) {
    low = std::min(low, p.z());
    high = std::max(high, p.z());
  }
  const GaussRule rule = gauss_legendre(6);
  const int parts = 24;
  double sum = 0.0;
  double moment = 0.0;
  for (int k = 0; k < parts; ++k) {
    for (size_t g = 0; g < rule.nodes.size(); ++g) {
      const double h = low + (high - low) * (k + rule.nodes[g]) / parts;
      const double area = section(model, n, h).area;
      EXPECT_GE(area, -1e-13);
      sum += (high - low) / parts * rule.weights[g] * area;
      moment += (high - low) / parts * rule.weights[g] * area * h;
    }
  }
  // The area has corners where the plane touches the surface; the rule does not know where.
  EXPECT_NEAR(sum, volume, 1e-4 * volume);
  EXPECT_GT(moment, 0.0);
}

TEST(Section, SignChangesOfPolynomials) {
  using internal::sign_changes;
  EXPECT_TRUE(sign_changes({1, 2, 1}).empty());
  EXPECT_TRUE(sign_changes({0, 0}).empty());
  const auto one = sign_changes({-1, 3});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_NEAR(one[0], 0.25, 1e-15);
  // (t - 1/4) (t - 3/4), with Bernstein coefficients 3/16, -5/16, 3/16.
  const auto two = sign_changes({3, -5, 3});
  ASSERT_EQ(two.size(), 2U);
  EXPECT_NEAR(two[0], 0.25, 1e-14);
  EXPECT_NEAR(two[1], 0.75, 1e-14);
}

TEST(Section, NeedsADirection) {
  const PatchModel cube = testing::make_cube_model(1, 1);
  EXPECT_THROW(section(cube, Vec3::Zero(), 0.0), PreconditionError);
  EXPECT_THROW(section(cube, Vec3(1, 0, std::nan("")), 0.0), PreconditionError);
  EXPECT_THROW(section(cube, Vec3(1, 0, 0), std::numeric_limits<double>::infinity()),
               PreconditionError);
}

}  // namespace
}  // namespace isochor
