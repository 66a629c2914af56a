#include "isochor/picture/raster.h"

#include <gtest/gtest.h>

#include <random>

#include "io/meshes.h"
#include "isochor/base/error.h"

namespace isochor {
namespace {

constexpr Rgb kRed = {0.9, 0.1, 0.1}, kBlue = {0.1, 0.1, 0.9};

// 20 x 20 pixels, one length unit each, the origin in the middle, seen against +z.
Camera flat_camera() {
  Camera camera = look_along(Vec3::UnitZ(), Vec3::UnitY());
  camera.width = camera.height = 20;
  return camera;
}

Mesh triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  Mesh mesh;
  mesh.positions = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

Mesh wall(double z, double size) {
  Mesh mesh;
  mesh.positions = {{-size, -size, z}, {size, -size, z}, {size, size, z}, {-size, size, z}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

bool reddish(const Image& image, int x, int y) {
  return image.pixel(x, y)[0] > image.pixel(x, y)[2] + 60;
}
bool bluish(const Image& image, int x, int y) {
  return image.pixel(x, y)[2] > image.pixel(x, y)[0] + 60;
}

TEST(Raster, AKnownTriangleCoversItsPixels) {
  Raster raster(flat_camera());
  // In pixels: (5, 15), (15, 15), (5, 5): the half below the falling diagonal.
  raster.draw(triangle({-5, -5, 0}, {5, -5, 0}, {-5, 5, 0}), kRed);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      if (x - 5 == y - 5) continue;  // the diagonal runs through these pixels
      const bool inside = x >= 5 && y < 15 && x - 5 < y - 5;
      EXPECT_EQ(raster.covered(x, y), inside) << x << " " << y;
    }
  }
}

TEST(Raster, NearerHidesFartherInEitherOrder) {
  Raster first(flat_camera()), second(flat_camera());
  first.draw(wall(0.0, 8), kBlue);
  first.draw(wall(1.0, 3), kRed);
  second.draw(wall(1.0, 3), kRed);
  second.draw(wall(0.0, 8), kBlue);
  EXPECT_EQ(first.image(), second.image());
  EXPECT_TRUE(reddish(first.image(), 10, 10));
  EXPECT_TRUE(bluish(first.image(), 4, 4));
}

TEST(Raster, CrossingTrianglesAreSplitWhereTheyCross) {
  Raster raster(flat_camera());
  raster.draw(triangle({-9, -9, -9}, {9, -9, 9}, {0, 9, 0}), kRed);
  raster.draw(triangle({-9, -9, 9}, {9, -9, -9}, {0, 9, 0}), kBlue);
  EXPECT_TRUE(bluish(raster.image(), 5, 17));
  EXPECT_TRUE(reddish(raster.image(), 14, 17));
}

TEST(Raster, SharedEdgesLeaveNoGapAndDrawNothingTwice) {
  // A fan of thin triangles with corners anywhere: opposite windings are drawn on top, and a sample
  // that both claimed or both left out would show.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-9.0, 9.0);
  for (int round = 0; round < 20; ++round) {
    Mesh mesh;
    mesh.positions = {Vec3(any(random), any(random), 0.0)};
    for (const auto& [x, y] : {std::pair(-20, -20), {20, -20}, {20, 20}, {-20, 20}}) {
      mesh.positions.emplace_back(x + 0.1 * any(random), y + 0.1 * any(random), 0.0);
    }
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
    Raster raster(flat_camera());
    raster.draw(mesh, kRed);
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 20; ++x) ASSERT_TRUE(raster.covered(x, y)) << x << " " << y;
    }
    const Image image = raster.image();
    for (int k = 1; k < 400; ++k) ASSERT_TRUE(reddish(image, k % 20, k / 20));
  }
}

TEST(Raster, IsDeterministicToTheBit) {
  const auto draw = [] {
    Camera camera = look_along(Vec3(1, -2, 1.5), Vec3::UnitZ());
    camera.width = 90, camera.height = 70, camera.scale = 30.0;
    Raster raster(camera);
    Mesh box = testing::box_mesh(1, 1, 1);
    complete_normals(box);
    box.scalars = {-1, -0.5, 0, 0.25, 0.5, 0.75, 1, 0};
    raster.draw(box, ColourScale(1.0));
    raster.outline();
    LineSet lines;
    lines.add(box.positions);
    raster.draw(lines);
    return raster.image();
  };
  EXPECT_EQ(draw(), draw());
}

TEST(Raster, LinesOnTheSurfaceShowAndBehindItDoNot) {
  Raster raster(flat_camera());
  raster.draw(wall(0.0, 9), {1.0, 1.0, 1.0});
  LineSet on, behind;
  on.colour = behind.colour = {0.0, 0.0, 0.0};
  on.width = behind.width = 2.0;
  on.add({Vec3(-8, 5, 0), Vec3(8, 5, 0)});
  behind.add({Vec3(-8, -5, -5), Vec3(8, -5, -5)});
  raster.draw(on);
  raster.draw(behind);
  const Image image = raster.image();
  EXPECT_LT(image.pixel(10, 4)[0], 40);
  EXPECT_GT(image.pixel(10, 14)[0], 150);
}

TEST(Raster, CrossingLinesOfOneSetAreNotDarkerWhereTheyCross) {
  Raster raster(flat_camera());
  LineSet cross;
  cross.width = 4.0;
  cross.opacity = 0.5;
  cross.add({Vec3(-8, 0, 0), Vec3(8, 0, 0)});
  cross.add({Vec3(0, -8, 0), Vec3(0, 8, 0)});
  raster.draw(cross);
  const Image image = raster.image();
  EXPECT_NEAR(image.pixel(10, 10)[1], image.pixel(4, 10)[1], 1);
}

TEST(Raster, DotsOnASlantedSurfaceAreWhole) {
  Mesh slope;
  slope.positions = {{-9, -9, -13}, {9, -9, -13}, {9, 9, 13}, {-9, 9, 13}};
  slope.triangles = {{0, 1, 2}, {0, 2, 3}};
  Raster raster(flat_camera());
  raster.draw(slope, {0.5, 0.5, 0.5});
  raster.dot(Vec3::Zero(), kRed, 4.0);
  const Image image = raster.image();
  for (const auto& [x, y] : {std::pair(10, 7), {10, 12}, {7, 10}, {12, 10}}) {
    EXPECT_TRUE(reddish(image, x, y)) << x << " " << y;
  }
  EXPECT_FALSE(reddish(image, 10, 4));
}

TEST(Raster, BackFacesAreToldApart) {
  Raster front(flat_camera()), back(flat_camera());
  Mesh mesh = wall(0.0, 9);
  front.draw(mesh, {0.6, 0.6, 0.6});
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  back.draw(mesh, {0.6, 0.6, 0.6});
  const Image a = front.image(), b = back.image();
  EXPECT_NEAR(a.pixel(10, 10)[0], a.pixel(10, 10)[2], 2);
  EXPECT_GT(b.pixel(10, 10)[0], b.pixel(10, 10)[2] + 8) << "warmer";
  EXPECT_LT(b.pixel(10, 10)[1], a.pixel(10, 10)[1] - 20) << "darker";
}

TEST(Raster, OutlineIsDrawnOnlyAtTheEdgeOfABody) {
  Raster plain(flat_camera()), outlined(flat_camera());
  for (Raster* raster : {&plain, &outlined}) raster->draw(wall(0.0, 6), {0.7, 0.7, 0.7});
  outlined.outline();
  const Image a = plain.image(), b = outlined.image();
  EXPECT_EQ(a.pixel(10, 10)[0], b.pixel(10, 10)[0]);
  EXPECT_LT(b.pixel(4, 10)[0], a.pixel(4, 10)[0] - 40);
  EXPECT_EQ(a.pixel(1, 10)[0], b.pixel(1, 10)[0]) << "outside";
}

TEST(Raster, ScalarsBecomeColours) {
  Raster raster(flat_camera());
  Mesh mesh = wall(0.0, 9);
  mesh.scalars = {-1.0, 1.0, 1.0, -1.0};
  raster.draw(mesh, ColourScale(1.0));
  EXPECT_TRUE(bluish(raster.image(), 3, 10));
  EXPECT_TRUE(reddish(raster.image(), 16, 10));
  mesh.scalars.clear();
  EXPECT_THROW(raster.draw(mesh, ColourScale(1.0)), PreconditionError);
}

TEST(Raster, FarAwayAndDegenerateTrianglesAreHarmless) {
  Raster raster(flat_camera());
  raster.draw(triangle({1e9, 0, 0}, {1e9 + 1, 0, 0}, {1e9, 1, 0}), kRed);
  raster.draw(triangle({0, 0, 0}, {1, 1, 0}, {2, 2, 0}), kRed);
  raster.draw(triangle({0, 0, 0}, {0, 0, 0}, {0, 0, 0}), kRed);
  raster.draw(Mesh(), kRed);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) EXPECT_FALSE(raster.covered(x, y));
  }
}

TEST(Raster, UnusableCamerasAreRefused) {
  Camera camera = flat_camera();
  camera.width = 0;
  EXPECT_THROW(Raster{camera}, PreconditionError);
  camera = flat_camera();
  camera.scale = 0.0;
  EXPECT_THROW(Raster{camera}, PreconditionError);
}

}  // namespace
}  // namespace isochor
