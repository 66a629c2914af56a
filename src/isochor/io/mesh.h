// Triangle meshes and line sets: what pictures are drawn from and mesh files are written from.
//
// Triangles are counter-clockwise seen from outside. Coordinates are in the model's length unit.
//
// Laws:
//  (1) enclosed_volume is additive, changes sign when every triangle is turned round, and does not
//      depend on where the origin is when the mesh is closed;
//  (2) append keeps every triangle's corners, normals, scalars and group.
#pragma once

#include <array>
#include <vector>

#include "isochor/base/vec3.h"

namespace isochor {

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;    // unit, outward; one a position, or empty
  std::vector<double> scalars;  // a value to colour by; one a position, or empty
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> groups;  // which patch or face a triangle belongs to; or empty

  bool empty() const { return triangles.empty(); }
};

// Segments of one colour and width.
struct LineSet {
  std::vector<Vec3> points;
  std::vector<std::array<int, 2>> segments;
  std::array<double, 3> colour = {0.16, 0.18, 0.21};  // sRGB, each in [0, 1]
  double width = 1.2;                                 // pixels of the finished picture
  double opacity = 1.0;

  bool empty() const { return segments.empty(); }
  // Adds the polyline through `line`.
  void add(const std::vector<Vec3>& line);
};

// Throws PreconditionError when an index, a size or a coordinate is not usable.
void require_usable(const Mesh& mesh);
void require_usable(const LineSet& lines);

// Adds `part` to `mesh`, with `group` for triangles of a part that has no groups. Normals and
// scalars are kept when both have them (an empty mesh takes what the part has), else dropped.
void append(Mesh& mesh, const Mesh& part, int group = 0);

// Normals averaged over the adjacent triangles, weighted by area; only where a position's normal is
// missing or zero. Cost O(#triangles).
void complete_normals(Mesh& mesh);

double area(const Mesh& mesh);
// The sum of the signed tetrahedra over all triangles: the volume when the mesh is closed.
double enclosed_volume(const Mesh& mesh);

// An axis-parallel box; empty when low > high.
struct Box {
  Vec3 low = Vec3::Constant(1e308), high = Vec3::Constant(-1e308);
  void add(const Vec3& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
  bool empty() const { return (low.array() > high.array()).any(); }
  Vec3 centre() const { return 0.5 * (low + high); }
  double diagonal() const { return empty() ? 0.0 : (high - low).norm(); }
};
// Of the positions that triangles use.
Box bounding_box(const Mesh& mesh);

}  // namespace isochor
