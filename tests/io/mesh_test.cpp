#include "isochor/io/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/meshes.h"
#include "isochor/base/error.h"

namespace isochor {
namespace {

using testing::box_mesh;

Mesh turned_round(Mesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  return mesh;
}

TEST(Mesh, MeasuresOfABoxAreExact) {
  const Mesh box = box_mesh(2.0, 3.0, 0.5);
  EXPECT_DOUBLE_EQ(enclosed_volume(box), 3.0);
  EXPECT_DOUBLE_EQ(area(box), 2.0 * (6.0 + 1.0 + 1.5));
  EXPECT_EQ(bounding_box(box).low, Vec3::Zero());
  EXPECT_EQ(bounding_box(box).high, Vec3(2.0, 3.0, 0.5));
}

TEST(Mesh, VolumeChangesSignWhenTurnedRound) {
  EXPECT_DOUBLE_EQ(enclosed_volume(turned_round(box_mesh(1, 2, 3))), -6.0);
}

TEST(Mesh, VolumeOfAClosedMeshDoesNotDependOnTheOrigin) {
  Mesh far = box_mesh(1, 2, 3);
  for (Vec3& p : far.positions) p += Vec3::Constant(1048576.0);
  EXPECT_DOUBLE_EQ(enclosed_volume(far), 6.0);
}

TEST(Mesh, AppendAddsVolumesAndKeepsGroups) {
  Mesh whole = box_mesh(1, 1, 1);
  Mesh part = box_mesh(2, 2, 2);
  part.groups.assign(part.triangles.size(), 9);
  append(whole, part, 5);
  append(whole, box_mesh(3, 3, 3), 6);
  EXPECT_NEAR(enclosed_volume(whole), 1.0 + 8.0 + 27.0, 1e-12);
  ASSERT_EQ(whole.groups.size(), 36u);
  EXPECT_EQ(whole.groups[0], 0);
  EXPECT_EQ(whole.groups[12], 9) << "a part's own groups win";
  EXPECT_EQ(whole.groups[35], 6);
  EXPECT_NO_THROW(require_usable(whole));
}

TEST(Mesh, AppendKeepsValuesOnlyWhenBothHaveThem) {
  Mesh with = box_mesh(1, 1, 1);
  complete_normals(with);
  with.scalars.assign(8, 2.5);
  Mesh whole;
  append(whole, with);
  append(whole, with);
  EXPECT_EQ(whole.normals.size(), 16u);
  EXPECT_EQ(whole.scalars.size(), 16u);
  append(whole, box_mesh(1, 1, 1));
  EXPECT_TRUE(whole.normals.empty());
  EXPECT_TRUE(whole.scalars.empty());
}

TEST(Mesh, CompletedNormalsPointOutwardsAndGivenOnesStay) {
  Mesh box = box_mesh(1, 1, 1);
  box.normals.assign(8, Vec3::Zero());
  box.normals[3] = Vec3(0, 0, -1);
  complete_normals(box);
  EXPECT_EQ(box.normals[3], Vec3(0, 0, -1));
  for (size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(box.normals[i].norm(), 1.0, 1e-15);
    if (i == 3) continue;
    EXPECT_GT(box.normals[i].dot(box.positions[i] - Vec3::Constant(0.5)), 0.5);
  }
}

TEST(Mesh, UnusableMeshesAreRefused) {
  Mesh bad = box_mesh(1, 1, 1);
  bad.triangles[4][1] = 8;
  EXPECT_THROW(require_usable(bad), PreconditionError);
  bad = box_mesh(1, 1, 1);
  bad.positions[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(require_usable(bad), PreconditionError);
  bad = box_mesh(1, 1, 1);
  bad.scalars.assign(7, 0.0);
  EXPECT_THROW(require_usable(bad), PreconditionError);
  LineSet lines;
  lines.points = {Vec3::Zero()};
  lines.segments = {{0, 1}};
  EXPECT_THROW(require_usable(lines), PreconditionError);
}

TEST(Mesh, EmptyMeshesHaveNoMeasure) {
  EXPECT_EQ(enclosed_volume(Mesh()), 0.0);
  EXPECT_EQ(area(Mesh()), 0.0);
  EXPECT_TRUE(bounding_box(Mesh()).empty());
  EXPECT_EQ(bounding_box(Mesh()).diagonal(), 0.0);
}

TEST(LineSet, AddJoinsNeighboursOnly) {
  LineSet lines;
  lines.add({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)});
  lines.add({});
  lines.add({Vec3(5, 0, 0)});
  lines.add({Vec3(7, 0, 0), Vec3(8, 0, 0)});
  EXPECT_EQ(lines.segments, (std::vector<std::array<int, 2>>{{0, 1}, {1, 2}, {4, 5}}));
}

}  // namespace
}  // namespace isochor
