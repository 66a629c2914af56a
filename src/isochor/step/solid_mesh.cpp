#include "isochor/step/solid_mesh.h"

#include "isochor/base/error.h"
#include "isochor/step/bridge.h"
#include "isochor/step/document_mesh.h"
#include "isochor/step/model_bytes.h"

namespace isochor {

template <typename Io>
void transfer(Io& io, FaceMesh& f) {
  io(f.face, f.positions, f.normals, f.uv, f.triangles);
}
template <typename Io>
void transfer(Io& io, EdgeLine& f) {
  io(f.edge, f.points);
}
template <typename Io>
void transfer(Io& io, SolidMesh& f) {
  io(f.faces, f.edges);
}

SolidMesh mesh_solid(const std::string& path, const SolidMeshOptions& options) {
  return call_in_child<SolidMesh>(
      path, [&] { return internal::document_mesh(internal::load_document(path), options); },
      options.limits, options.watch);
}

FaceMesh on_surface(const FaceMesh& mesh, const Surface& surface, bool reversed) {
  ISOCHOR_REQUIRE(mesh.uv.size() == mesh.positions.size(), mesh.uv.size(), mesh.positions.size());
  FaceMesh moved = mesh;
  for (size_t k = 0; k < mesh.uv.size(); ++k) {
    moved.positions[k] = surface.point(mesh.uv[k].u, mesh.uv[k].v);
    const Vec3 normal = surface.normal(mesh.uv[k].u, mesh.uv[k].v);
    if (normal != Vec3::Zero()) moved.normals[k] = reversed ? Vec3(-normal) : normal;
  }
  return moved;
}

}  // namespace isochor
