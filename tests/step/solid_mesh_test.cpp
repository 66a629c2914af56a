#include "isochor/step/solid_mesh.h"

#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepTools.hxx>
#include <cmath>
#include <filesystem>

#include "isochor/base/error.h"
#include "isochor/step/document_mesh.h"
#include "isochor/step/document_model.h"
#include "step/shapes.h"

namespace isochor::internal {
namespace {

double volume_of(const SolidMesh& mesh) {
  double volume = 0.0;
  for (const FaceMesh& face : mesh.faces) {
    for (const auto& t : face.triangles) {
      const Vec3& a = face.positions[static_cast<size_t>(t[0])];
      const Vec3& b = face.positions[static_cast<size_t>(t[1])];
      const Vec3& c = face.positions[static_cast<size_t>(t[2])];
      volume += a.dot(b.cross(c)) / 6.0;
    }
  }
  return volume;
}

void expect_outward_normals(const SolidMesh& mesh) {
  for (const FaceMesh& face : mesh.faces) {
    ASSERT_EQ(face.normals.size(), face.positions.size());
    ASSERT_FALSE(face.triangles.empty()) << face.face;
    for (const auto& t : face.triangles) {
      const auto at = [&](size_t k) { return face.positions[static_cast<size_t>(t[k])]; };
      const Vec3 n = (at(1) - at(0)).cross(at(2) - at(0));
      if (n.norm() < 1e-6) continue;  // slivers at poles are flatter than the surface
      for (int k : t) {
        const Vec3& normal = face.normals[static_cast<size_t>(k)];
        EXPECT_NEAR(normal.norm(), 1.0, 1e-12);
        EXPECT_GE(normal.dot(n), -1e-9 * n.norm()) << face.face;
      }
    }
  }
}

// The mesh of a closed shape encloses its volume but for the chord error.
TEST(SolidMesh, TrianglesEncloseTheVolume) {
  const std::vector<TopoDS_Shape> solids = {
      shapes::bicubic_cube(), shapes::dome(), shapes::barrel(true), shapes::holed_cube(),
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(2, 3, 1).Shape(),
                      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(1, 1, -1), gp::DZ()), 0.4, 3).Shape())
          .Shape()};
  for (const TopoDS_Shape& solid : solids) {
    const auto document = shapes::document_of(solid);
    const SolidMesh mesh = document_mesh(document);
    const SolidModel model = document_model(document);
    EXPECT_EQ(mesh.faces.size(), model.faces.size());
    EXPECT_NEAR(volume_of(mesh), model.facts.volume, 5e-3 * model.facts.volume);
    expect_outward_normals(mesh);
  }
}

TEST(SolidMesh, VerticesOfBSplineFacesLieOnTheSurfaceAndFollowIt) {
  const auto document = shapes::document_of(shapes::holed_cube());
  const SolidMesh mesh = document_mesh(document);
  const SolidModel model = document_model(document);
  for (const FaceMesh& face : mesh.faces) {
    const int q = model.faces[static_cast<size_t>(face.face)].patch;
    if (q < 0) {
      EXPECT_TRUE(face.uv.empty());
      continue;
    }
    std::vector<Vec3> moved = model.patches.points;
    for (Vec3& p : moved) p += Vec3(1, 2, 3);
    const bool reversed = model.patches.patches[static_cast<size_t>(q)].reversed;
    const FaceMesh same = on_surface(face, model.patches.surface(q), reversed);
    const FaceMesh shifted = on_surface(face, model.patches.surface(q, moved), reversed);
    double longest = 0.0;
    for (size_t k = 0; k < face.positions.size(); ++k) {
      EXPECT_LT((same.positions[k] - face.positions[k]).norm(), 1e-14);
      EXPECT_LT((shifted.positions[k] - face.positions[k] - Vec3(1, 2, 3)).norm(), 1e-13);
      EXPECT_LT((same.normals[k] - face.normals[k]).norm(), 1e-12);
    }
    for (const auto& t : face.triangles) {
      longest = std::max(longest, (face.positions[static_cast<size_t>(t[0])] -
                                   face.positions[static_cast<size_t>(t[1])])
                                      .norm());
    }
    EXPECT_LT(longest, 0.02 * model.facts.diagonal);
  }
}

TEST(SolidMesh, EdgesAreNumberedAsInTheModel) {
  const auto document = shapes::document_of(shapes::dome());
  const SolidMesh mesh = document_mesh(document);
  const SolidModel model = document_model(document);
  size_t drawn = 0;
  for (const EdgeFacts& edge : model.edges) drawn += edge.degenerated ? 0 : 1;
  ASSERT_EQ(mesh.edges.size(), drawn);
  for (const EdgeLine& line : mesh.edges) {
    double length = 0.0;
    for (size_t k = 1; k < line.points.size(); ++k) {
      length += (line.points[k] - line.points[k - 1]).norm();
    }
    EXPECT_NEAR(length, model.edges[static_cast<size_t>(line.edge)].length, 0.02 * length);
  }
}

TEST(SolidMesh, ComesBackFromTheChildProcess) {
  const auto path = std::filesystem::temp_directory_path() / "isochor_solid_mesh.brep";
  ASSERT_TRUE(BRepTools::Write(shapes::bicubic_cube(), path.c_str()));
  const SolidMesh mesh = mesh_solid(path);
  EXPECT_EQ(mesh.faces.size(), 6u);
  EXPECT_EQ(mesh.edges.size(), 12u);
  std::filesystem::remove(path);
  EXPECT_THROW(mesh_solid(path), InputError);
}

TEST(SolidMesh, FaceWithoutParametersHasNoOtherSurface) {
  FaceMesh mesh;
  mesh.positions.resize(3);
  const Surface surface(KnotVector::uniform(1, 1), KnotVector::uniform(1, 1),
                        std::vector<Vec3>(4, Vec3::Zero()));
  EXPECT_THROW(on_surface(mesh, surface, false), PreconditionError);
}

}  // namespace
}  // namespace isochor::internal
