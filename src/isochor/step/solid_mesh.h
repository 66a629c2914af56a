// Triangles and lines of a solid for pictures. No OpenCASCADE types here.
//
// Laws:
//  (1) triangles of a face run round its outward normal;
//  (2) vertices of a B-spline face lie on its surface at their uv, so that the same mesh shows the
//      face after an edit;
//  (3) faces and edges have the numbers they have in SolidModel.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/step/solid_model.h"

namespace isochor {

struct FaceMesh {
  int face = 0;                 // 0-based
  std::vector<Vec3> positions;  // in the file's unit
  std::vector<Vec3> normals;    // outward, unit; one per position
  std::vector<Uv> uv;           // of B-spline faces; else empty
  std::vector<std::array<int, 3>> triangles;
};

struct EdgeLine {
  int edge = 0;  // 0-based, index into SolidModel::edges
  std::vector<Vec3> points;
};

struct SolidMesh {
  std::vector<FaceMesh> faces;  // all, in order; one that could not be meshed has no triangles
  std::vector<EdgeLine> edges;  // degenerated ones left out
};

struct SolidMeshOptions {
  double deflection = 5e-4;    // chord error, relative to the diagonal of the shape
  double angle_rad = 0.25;     // between neighbouring normals
  double longest_edge = 0.02;  // of triangles on B-spline faces, relative to the diagonal
  BridgeLimits limits;
  Watch watch;
};

// Reads and meshes in a child process. Throws InputError like read_solid.
SolidMesh mesh_solid(const std::string& path, const SolidMeshOptions& options = {});

// The mesh of a B-spline face with the poles of `surface` instead: positions and normals at the
// same uv. `reversed` as in Patch.
FaceMesh on_surface(const FaceMesh& mesh, const Surface& surface, bool reversed);

}  // namespace isochor
