#include "isochor/step/document_mesh.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <GCPnts_TangentialDeflection.hxx>
#include <Poly_Triangulation.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <map>

#include "isochor/base/tolerance.h"
#include "isochor/step/brep_table.h"

namespace isochor::internal {
namespace {

constexpr size_t kMostTriangles = 40000;  // per face; refinement stops there

Vec3 vec(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }

// The outward unit normal, or zero where the parametrisation is singular.
Vec3 normal_at(const FaceRecord& face, const Uv& at) {
  gp_Pnt p;
  gp_Vec du, dv;
  face.surface.geometry->D1(at.u, at.v, p, du, dv);
  const Vec3 n = vec(du.Crossed(dv).XYZ());
  const double size = n.norm();
  if (!(size > kCoincident * du.Magnitude() * dv.Magnitude())) return Vec3::Zero();
  return n / (face.reversed() ? -size : size);
}

// Normals that the surface does not give are the mean of the triangles around.
void complete_normals(FaceMesh& mesh) {
  std::vector<Vec3> sums(mesh.positions.size(), Vec3::Zero());
  for (const auto& t : mesh.triangles) {
    const auto at = [&](int k) -> const Vec3& {
      return mesh.positions[static_cast<size_t>(t[static_cast<size_t>(k)])];
    };
    const Vec3 n = (at(1) - at(0)).cross(at(2) - at(0));
    for (int k : t) sums[static_cast<size_t>(k)] += n;
  }
  for (size_t k = 0; k < sums.size(); ++k) {
    if (mesh.normals[k] != Vec3::Zero()) continue;
    const double size = sums[k].norm();
    mesh.normals[k] = size > 0.0 ? Vec3(sums[k] / size) : Vec3(Vec3::UnitZ());
  }
}

// Cuts edges longer than `longest` at the middle of their uv; new vertices lie on the surface. Both
// triangles at an edge cut it, so the mesh of the face stays connected.
class Splitter {
 public:
  Splitter(FaceMesh& mesh, const FaceRecord& face, double longest)
      : mesh_(mesh), face_(face), longest_(longest) {}

  // False when no edge was long.
  bool split() {
    middles_.clear();
    std::vector<std::array<int, 3>> finer;
    for (const auto& t : mesh_.triangles) add(t, finer);
    mesh_.triangles = std::move(finer);
    return !middles_.empty();
  }

 private:
  // The vertex in the middle of a long edge, or -1.
  int middle(int a, int b) {
    const auto i = static_cast<size_t>(a);
    const auto j = static_cast<size_t>(b);
    if ((mesh_.positions[i] - mesh_.positions[j]).norm() <= longest_) return -1;
    const auto [it, added] =
        middles_.try_emplace(std::minmax(a, b), static_cast<int>(mesh_.positions.size()));
    if (added) {
      const Uv at{0.5 * (mesh_.uv[i].u + mesh_.uv[j].u), 0.5 * (mesh_.uv[i].v + mesh_.uv[j].v)};
      mesh_.uv.push_back(at);
      mesh_.positions.push_back(vec(face_.surface.geometry->Value(at.u, at.v).XYZ()));
      mesh_.normals.push_back(normal_at(face_, at));
    }
    return it->second;
  }

  void add(std::array<int, 3> t, std::vector<std::array<int, 3>>& finer) {
    std::array<int, 3> m = {middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])};
    const auto cuts = std::count_if(m.begin(), m.end(), [](int k) { return k >= 0; });
    if (cuts == 0) {
      finer.push_back(t);
    } else if (cuts == 3) {
      finer.insert(
          finer.end(),
          {{t[0], m[0], m[2]}, {m[0], t[1], m[1]}, {m[2], m[1], t[2]}, {m[0], m[1], m[2]}});
    } else {
      // Turned so that the first edge is cut and, of two cuts, the other is the second edge.
      while (m[0] < 0 || (cuts == 2 && m[1] < 0)) {
        std::rotate(t.begin(), t.begin() + 1, t.end());
        std::rotate(m.begin(), m.begin() + 1, m.end());
      }
      if (cuts == 1) {
        finer.insert(finer.end(), {{t[0], m[0], t[2]}, {m[0], t[1], t[2]}});
      } else {
        finer.insert(finer.end(), {{m[0], t[1], m[1]}, {t[0], m[0], m[1]}, {t[0], m[1], t[2]}});
      }
    }
  }

  FaceMesh& mesh_;
  const FaceRecord& face_;
  double longest_;
  std::map<std::pair<int, int>, int> middles_;
};

FaceMesh face_mesh(const FaceRecord& face, int number, double longest) {
  FaceMesh mesh;
  mesh.face = number;
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face.face, location);
  if (triangles.IsNull() || !triangles->HasUVNodes()) return mesh;
  for (int k = 1; k <= triangles->NbNodes(); ++k) {
    const gp_Pnt2d uv = triangles->UVNode(k);
    mesh.uv.push_back({uv.X(), uv.Y()});
    mesh.normals.push_back(normal_at(face, mesh.uv.back()));
    // Nodes on edges are points of the edges; those of B-spline faces go back to the surface.
    mesh.positions.push_back(
        face.surface.bspline
            ? vec(face.surface.geometry->Value(uv.X(), uv.Y()).XYZ())
            : vec(triangles->Node(k).Transformed(location.Transformation()).XYZ()));
  }
  for (int k = 1; k <= triangles->NbTriangles(); ++k) {
    int a = 0;
    int b = 0;
    int c = 0;
    triangles->Triangle(k).Get(a, b, c);
    if (face.reversed()) std::swap(b, c);
    mesh.triangles.push_back({a - 1, b - 1, c - 1});
  }
  Splitter splitter(mesh, face, longest);
  while (face.surface.bspline && mesh.triangles.size() < kMostTriangles && splitter.split()) {
  }
  complete_normals(mesh);
  if (!face.surface.bspline) mesh.uv.clear();
  return mesh;
}

EdgeLine edge_line(const EdgeRecord& record, int number, double deflection, double angle_rad) {
  EdgeLine line;
  line.edge = number;
  if (BRep_Tool::Degenerated(record.edge) || !BRep_Tool::IsGeometric(record.edge)) return line;
  const BRepAdaptor_Curve curve(record.edge);
  const GCPnts_TangentialDeflection points(curve, angle_rad, deflection);
  for (int k = 1; k <= points.NbPoints(); ++k) line.points.push_back(vec(points.Value(k).XYZ()));
  return line;
}

}  // namespace

SolidMesh document_mesh(const Document& document, const SolidMeshOptions& options) {
  const BrepTable table =
      brep_table(document.shape, document.faces, {}, changed_by_reader(document));
  const double deflection = options.deflection * table.diagonal;
  BRepTools::Clean(document.shape);
  BRepMesh_IncrementalMesh(document.shape, deflection, Standard_False, options.angle_rad);
  SolidMesh mesh;
  for (size_t f = 0; f < table.faces.size(); ++f) {
    mesh.faces.push_back(
        face_mesh(table.faces[f], static_cast<int>(f), options.longest_edge * table.diagonal));
  }
  for (size_t e = 0; e < table.edges.size(); ++e) {
    EdgeLine line = edge_line(table.edges[e], static_cast<int>(e), deflection, options.angle_rad);
    if (!line.points.empty()) mesh.edges.push_back(std::move(line));
  }
  return mesh;
}

}  // namespace isochor::internal
