// OBJ, STL and GLB files, parsed back.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/meshes.h"
#include "io/temp_folder.h"
#include "isochor/base/error.h"
#include "isochor/io/file.h"
#include "isochor/io/mesh_glb.h"
#include "isochor/io/mesh_obj.h"
#include "isochor/io/mesh_stl.h"

namespace isochor {
namespace {

using testing::box_mesh;

std::uint32_t unsigned_at(const std::string& bytes, size_t at, int count = 4) {
  std::uint32_t value = 0;
  for (int k = 0; k < count; ++k) {
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(at + k))) << (8 * k);
  }
  return value;
}

float float_at(const std::string& bytes, size_t at) {
  const std::uint32_t pattern = unsigned_at(bytes, at);
  float value = 0.0f;
  std::memcpy(&value, &pattern, sizeof value);
  return value;
}

Vec3 vector_at(const std::string& bytes, size_t at) {
  return {float_at(bytes, at), float_at(bytes, at + 4), float_at(bytes, at + 8)};
}

// Coordinates that need all their digits.
Mesh awkward_mesh() {
  Mesh mesh = box_mesh(0.1 + 0.2, 1.0 / 3.0, 1e-300);
  mesh.positions[7] = Vec3(-0.0, std::nextafter(1.0, 2.0), 123456789.123456789);
  mesh.groups.assign(12, 0);
  for (size_t k = 6; k < 12; ++k) mesh.groups[k] = 1;
  return mesh;
}

struct ParsedObj {
  Mesh mesh;
  std::vector<std::string> groups;
};

ParsedObj parse_obj(const std::string& text) {
  ParsedObj parsed;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string keyword, a, b, c;
    words >> keyword >> a >> b >> c;
    if (keyword == "v" || keyword == "vn") {
      const Vec3 p(std::stod(a), std::stod(b), std::stod(c));
      (keyword == "v" ? parsed.mesh.positions : parsed.mesh.normals).push_back(p);
    } else if (keyword == "g") {
      parsed.groups.push_back(a);
    } else if (keyword == "f") {
      parsed.mesh.triangles.push_back({std::stoi(a) - 1, std::stoi(b) - 1, std::stoi(c) - 1});
    }
  }
  return parsed;
}

TEST(Obj, ReadsBackTheSameDoubles) {
  Mesh mesh = awkward_mesh();
  mesh.positions[0].x() = std::numeric_limits<double>::min();
  mesh.positions[1].x() = 1e300;
  const Mesh back = parse_obj(obj_text(mesh)).mesh;
  EXPECT_EQ(back.positions, mesh.positions);
  EXPECT_EQ(back.triangles, mesh.triangles);
}

TEST(Obj, NormalsAreReferredTo) {
  Mesh mesh = box_mesh(1, 2, 3);
  complete_normals(mesh);
  const std::string text = obj_text(mesh);
  EXPECT_EQ(parse_obj(text).mesh.normals, mesh.normals);
  EXPECT_NE(text.find("f 1//1 3//3 4//4\n"), std::string::npos);
}

TEST(Obj, GroupsAreNamedAndNamesCannotBreakTheFile) {
  Mesh mesh = awkward_mesh();
  mesh.groups[11] = 2;
  const ParsedObj parsed = parse_obj(obj_text(mesh, {"face:1", "upper wing\nf 1 2 3"}));
  EXPECT_EQ(parsed.groups, (std::vector<std::string>{"face:1", "upper_wing_f_1_2_3", "group_2"}));
  EXPECT_EQ(parsed.mesh.triangles.size(), 12u);
}

TEST(Stl, ReadsBackCornersAndNormals) {
  const Mesh mesh = box_mesh(0.5, 2.0, 4.0);
  const std::string bytes = stl_bytes(mesh);
  ASSERT_EQ(bytes.size(), 84u + 50u * 12u);
  EXPECT_NE(bytes.substr(0, 5), "solid");
  ASSERT_EQ(unsigned_at(bytes, 80), 12u);
  double volume = 0.0;
  for (size_t k = 0; k < 12; ++k) {
    const size_t at = 84 + 50 * k;
    Vec3 corner[3];
    for (size_t c = 0; c < 3; ++c) {
      corner[c] = vector_at(bytes, at + 12 * (c + 1));
      EXPECT_EQ(corner[c], mesh.positions[static_cast<size_t>(mesh.triangles[k][c])]);
    }
    const Vec3 cross = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    EXPECT_LT((vector_at(bytes, at) - cross.normalized()).norm(), 1e-6);
    volume += corner[0].dot(corner[1].cross(corner[2])) / 6.0;
    EXPECT_EQ(unsigned_at(bytes, at + 48, 2), 0u);
  }
  EXPECT_DOUBLE_EQ(volume, 4.0);
}

TEST(Stl, DegenerateTrianglesHaveAZeroNormalAndHugeNumbersAreRefused) {
  Mesh mesh = box_mesh(1, 1, 1);
  mesh.triangles = {{0, 0, 1}};
  EXPECT_EQ(vector_at(stl_bytes(mesh), 84), Vec3::Zero());
  mesh.positions[1].x() = 1e39;
  EXPECT_THROW(stl_bytes(mesh), PreconditionError);
}

struct ParsedGlb {
  nlohmann::json json;
  std::string binary;

  const nlohmann::json& accessor(int i) const { return json["accessors"][i]; }
  size_t offset(int accessor_index) const {
    return json["bufferViews"][accessor(accessor_index)["bufferView"].get<int>()]["byteOffset"];
  }
};

// Checks the container while it takes it apart.
ParsedGlb parse_glb(const std::string& bytes) {
  ParsedGlb parsed;
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(unsigned_at(bytes, 4), 2u);
  EXPECT_EQ(unsigned_at(bytes, 8), bytes.size());
  const size_t json_size = unsigned_at(bytes, 12);
  EXPECT_EQ(json_size % 4, 0u);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  parsed.json = nlohmann::json::parse(bytes.substr(20, json_size));
  const size_t binary_size = unsigned_at(bytes, 20 + json_size);
  EXPECT_EQ(bytes.substr(24 + json_size, 4), std::string("BIN\0", 4));
  parsed.binary = bytes.substr(28 + json_size);
  EXPECT_EQ(parsed.binary.size(), binary_size);
  EXPECT_EQ(binary_size % 4, 0u);
  EXPECT_EQ(parsed.json["buffers"][0]["byteLength"], binary_size);
  return parsed;
}

TEST(Glb, GeometryIsUprightInMetresAndExactAroundTheMiddle) {
  Mesh mesh = box_mesh(1000, 2000, 4000);
  for (Vec3& p : mesh.positions) p += Vec3(1e8, -2e8, 3e8);
  complete_normals(mesh);
  GlbOptions options;
  options.metres_per_unit = 1.0 / 1024;
  const ParsedGlb glb = parse_glb(glb_bytes(mesh, {}, options));
  const auto& primitive = glb.json["meshes"][0]["primitives"][0];
  const auto& t = glb.json["nodes"][0]["translation"];
  const Vec3 translation(t[0], t[1], t[2]);
  const int positions = primitive["attributes"]["POSITION"];
  const int normals = primitive["attributes"]["NORMAL"];
  ASSERT_EQ(glb.accessor(positions)["count"], 8);
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (size_t i = 0; i < 8; ++i) {
    const Vec3 local = vector_at(glb.binary, glb.offset(positions) + 12 * i);
    low = low.cwiseMin(local), high = high.cwiseMax(local);
    const Vec3 at = 1024.0 * (local + translation);
    EXPECT_LT((Vec3(at.x(), -at.z(), at.y()) - mesh.positions[i]).norm(), 1e-6);
    const Vec3 n = vector_at(glb.binary, glb.offset(normals) + 12 * i);
    EXPECT_LT((Vec3(n.x(), -n.z(), n.y()) - mesh.normals[i]).norm(), 1e-6);
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(glb.accessor(positions)["min"][c].get<float>(), static_cast<float>(low[c]));
    EXPECT_EQ(glb.accessor(positions)["max"][c].get<float>(), static_cast<float>(high[c]));
  }
  const int indices = primitive["indices"];
  ASSERT_EQ(glb.accessor(indices)["count"], 36);
  for (size_t k = 0; k < 36; ++k) {
    EXPECT_EQ(unsigned_at(glb.binary, glb.offset(indices) + 4 * k),
              static_cast<std::uint32_t>(mesh.triangles[k / 3][k % 3]));
  }
}

TEST(Glb, TurningUprightKeepsTheOrientation) {
  const Mesh mesh = box_mesh(1, 2, 3);
  const ParsedGlb glb = parse_glb(glb_bytes(mesh));
  Mesh back;
  for (size_t i = 0; i < 8; ++i) back.positions.push_back(vector_at(glb.binary, 12 * i));
  back.triangles = mesh.triangles;
  EXPECT_NEAR(enclosed_volume(back), 6.0, 1e-6);
}

TEST(Glb, MaterialIsMatteAndColoursAreWritten) {
  const Mesh mesh = box_mesh(1, 1, 1);
  GlbOptions options;
  options.colours.assign(8, {0.0, 0.5, 2.0});
  const ParsedGlb glb = parse_glb(glb_bytes(mesh, {}, options));
  const auto& material = glb.json["materials"][0];
  EXPECT_EQ(material["pbrMetallicRoughness"]["metallicFactor"], 0);
  EXPECT_EQ(material["doubleSided"], true);
  const int colours = glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"];
  EXPECT_EQ(glb.accessor(colours)["componentType"], 5123);
  EXPECT_EQ(glb.accessor(colours)["normalized"], true);
  const size_t at = glb.offset(colours);
  EXPECT_EQ(unsigned_at(glb.binary, at, 2), 0u);
  EXPECT_EQ(unsigned_at(glb.binary, at + 2, 2), 32768u);
  EXPECT_EQ(unsigned_at(glb.binary, at + 4, 2), 65535u) << "clipped";
  EXPECT_EQ(unsigned_at(glb.binary, at + 6, 2), 65535u) << "opaque";
}

TEST(Glb, LinesAreAPrimitiveOfTheirOwn) {
  LineSet lines;
  lines.add({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0)});
  const ParsedGlb glb = parse_glb(glb_bytes(box_mesh(1, 1, 1), {LineSet(), lines}));
  ASSERT_EQ(glb.json["meshes"][0]["primitives"].size(), 2u) << "empty sets are left out";
  const auto& primitive = glb.json["meshes"][0]["primitives"][1];
  EXPECT_EQ(primitive["mode"], 1);
  EXPECT_EQ(glb.accessor(primitive["indices"])["count"], 4);
}

TEST(Glb, UnitsAreKnownByName) {
  EXPECT_EQ(metres_per_unit("mm"), 1e-3);
  EXPECT_EQ(metres_per_unit("inch"), 0.0254);
  EXPECT_EQ(metres_per_unit("ft"), 0.3048);
  EXPECT_FALSE(metres_per_unit("parsec").has_value());
}

TEST(Glb, UnusableInputIsRefused) {
  EXPECT_THROW(glb_bytes(Mesh()), PreconditionError);
  GlbOptions options;
  options.metres_per_unit = 0.0;
  EXPECT_THROW(glb_bytes(box_mesh(1, 1, 1), {}, options), PreconditionError);
  options = {};
  options.colours.resize(3);
  EXPECT_THROW(glb_bytes(box_mesh(1, 1, 1), {}, options), PreconditionError);
}

TEST(MeshFiles, AppearCompleteOrNotAtAll) {
  const testing::TempFolder folder;
  const Mesh mesh = box_mesh(1, 2, 3);
  write_obj(folder.file("a.obj"), mesh);
  write_stl(folder.file("a.stl"), mesh);
  write_glb(folder.file("a.glb"), mesh);
  EXPECT_EQ(read_file(folder.file("a.obj")), obj_text(mesh));
  EXPECT_EQ(read_file(folder.file("a.stl")), stl_bytes(mesh));
  EXPECT_EQ(read_file(folder.file("a.glb")), glb_bytes(mesh));
  EXPECT_EQ(folder.file_count(), 3);
  Mesh bad = mesh;
  bad.triangles[0][0] = 99;
  EXPECT_THROW(write_obj(folder.file("b.obj"), bad), PreconditionError);
  EXPECT_THROW(write_stl(folder.file("b.stl"), bad), PreconditionError);
  EXPECT_THROW(write_glb(folder.file("b.glb"), bad), PreconditionError);
  EXPECT_EQ(folder.file_count(), 3);
  EXPECT_THROW(write_stl(folder.file("none/b.stl"), mesh), InputError);
}

}  // namespace
}  // namespace isochor
