// OBJ files as others write them.
#include <gtest/gtest.h>

#include <cmath>

#include "io/meshes.h"
#include "isochor/base/error.h"
#include "isochor/io/mesh_obj.h"

namespace isochor {
namespace {

using Triangle = std::array<int, 3>;

std::string reason_of(const std::string& text) {
  try {
    parse_obj(text, "a.obj");
  } catch (const InputError& error) {
    EXPECT_EQ(error.file(), "a.obj");
    return error.entity() + ": " + error.reason();
  }
  return "";
}

TEST(MeshObjReader, WhatWasWrittenComesBack) {
  Mesh mesh = testing::box_mesh(0.1 + 0.2, 1.0 / 3.0, 1e-300);
  mesh.positions[7] = Vec3(-0.0, std::nextafter(1.0, 2.0), 123456789.123456789);
  const Mesh again = parse_obj(obj_text(mesh), "a.obj");
  EXPECT_EQ(again.triangles, mesh.triangles);
  EXPECT_EQ(again.positions, mesh.positions);
}

TEST(MeshObjReader, PolygonsBecomeFansAndNegativeNumbersCountFromTheEnd) {
  const Mesh mesh = parse_obj(
      "# comment\nmtllib x.mtl\r\nv 0 0 0\nv +1 0 0 1.0\n  v 1 1 0 # corner\nv 0 1 0\n"
      "vt 0 0\nvn 0 0 1\no box\ng side\ns off\nusemtl grey\n"
      "f 1 2/1 3//1 4/1/1\nf -4 -3 -2\n",
      "a.obj");
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
  EXPECT_EQ(area(mesh), 1.5);
  require_usable(mesh);
}

TEST(MeshObjReader, ErrorsNameTheLine) {
  EXPECT_EQ(reason_of("v 0 0\n"), "line 1: a vertex has three coordinates");
  EXPECT_EQ(reason_of("\nv 0 0 NaN\n"), "line 2: 'NaN' is no coordinate");
  EXPECT_EQ(reason_of("v 0 0 1e999\n"), "line 1: '1e999' is no coordinate");
  EXPECT_EQ(reason_of("v 0 0 1x\n"), "line 1: '1x' is no coordinate");
  EXPECT_EQ(reason_of("v 0 0 0\nf 1 1\n"), "line 2: a face has at least three corners");
  EXPECT_EQ(reason_of("v 0 0 0\nf 1 1 2\n"), "line 2: '2': there are 1 vertices so far");
  EXPECT_EQ(reason_of("v 0 0 0\nf 1 1 0\n"), "line 2: '0': there are 1 vertices so far");
  EXPECT_EQ(reason_of("v 0 0 0\nf 1 1 -2\n"), "line 2: '-2': there are 1 vertices so far");
  EXPECT_EQ(reason_of("v 0 0 0\nf 1 1 a\n"), "line 2: 'a' is no corner of a face");
  EXPECT_EQ(reason_of("curv 1\n"), "line 1: unknown keyword 'curv'");
  EXPECT_EQ(reason_of(""), ": has no face");
  EXPECT_EQ(reason_of("v 0 0 0\n"), ": has no face");
}

}  // namespace
}  // namespace isochor
