// Small meshes with known measures.
#pragma once

#include "isochor/io/mesh.h"

namespace isochor::testing {

// The box [0, a] x [0, b] x [0, c]: 8 corners, 12 triangles, outward.
inline Mesh box_mesh(double a, double b, double c) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k) {
    mesh.positions.emplace_back(k & 1 ? a : 0.0, k & 2 ? b : 0.0, k & 4 ? c : 0.0);
  }
  const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

}  // namespace isochor::testing
