#include "isochor/picture/deviation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "io/meshes.h"
#include "isochor/base/error.h"
#include "isochor/picture/tessellate.h"
#include "support/models.h"

namespace isochor {
namespace {

using testing::box_mesh;

// The signed distance from the unit box, in closed form.
double box_distance(const Vec3& p) {
  const Vec3 q = (p - Vec3::Constant(0.5)).cwiseAbs() - Vec3::Constant(0.5);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

TEST(SignedDeviation, EqualsTheClosedFormOfABox) {
  Mesh points;
  std::mt19937 random(21);
  std::uniform_real_distribution<double> any(-1.0, 2.0);
  for (int k = 0; k < 3000; ++k)
    points.positions.emplace_back(any(random), any(random), any(random));
  const std::vector<double> values = signed_deviation(points, box_mesh(1, 1, 1));
  for (size_t k = 0; k < values.size(); ++k) {
    EXPECT_NEAR(values[k], box_distance(points.positions[k]), 1e-12)
        << points.positions[k].transpose();
  }
}

TEST(SignedDeviation, IsTheOffsetBetweenSpheres) {
  const Mesh inner = tessellate(testing::make_sphere(1.0));
  const Mesh outer = tessellate(testing::make_sphere(1.1));
  for (double d : signed_deviation(outer, inner)) EXPECT_NEAR(d, 0.1, 2e-3);
  for (double d : signed_deviation(inner, outer)) EXPECT_NEAR(d, -0.1, 2e-3);
}

TEST(SignedDeviation, IsZeroOnTheSameSurface) {
  const Mesh mesh = tessellate(testing::random_closed_model(5));
  for (double d : signed_deviation(mesh, mesh)) EXPECT_NEAR(d, 0.0, 1e-15);
}

TEST(SignedDeviation, DegenerateTrianglesDoNoHarm) {
  Mesh box = box_mesh(1, 1, 1);
  box.triangles.push_back({0, 0, 1});
  box.triangles.push_back({2, 2, 2});
  Mesh point;
  point.positions = {Vec3(0.5, 0.0, -0.25), Vec3(0.5, 0.5, 0.25)};
  const std::vector<double> values = signed_deviation(point, box);
  EXPECT_NEAR(values[0], 0.25, 1e-15);
  EXPECT_NEAR(values[1], -0.25, 1e-15);
}

TEST(SignedDeviation, AnEmptyReferenceIsRefused) {
  EXPECT_THROW(signed_deviation(box_mesh(1, 1, 1), Mesh()), PreconditionError);
  EXPECT_TRUE(signed_deviation(Mesh(), box_mesh(1, 1, 1)).empty());
}

}  // namespace
}  // namespace isochor
