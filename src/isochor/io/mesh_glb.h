// Binary glTF 2.0 (GLB): a mesh with normals and colours, and lines, for viewers and web pages.
//
// glTF is in metres with y up; (x, y, z) is written as (x, z, -y) times metres_per_unit. Positions
// have single precision, so they are written from the middle of the model, which becomes the
// translation of the node: large coordinates lose nothing.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "isochor/io/mesh.h"

namespace isochor {

struct GlbOptions {
  double metres_per_unit = 1.0;
  // Linear light in [0, 1], one a position, or empty: then `colour` is used.
  std::vector<std::array<double, 3>> colours;
  std::array<double, 3> colour = {0.39, 0.45, 0.53};  // linear
};

// The length of a unit by its name ("mm", "m", "inch", "ft", ...); none when not known.
std::optional<double> metres_per_unit(const std::string& unit);

// The bytes of the file; a matte, two-sided material. `lines` become line primitives.
// Throws PreconditionError when the mesh is empty or sizes do not fit.
std::string glb_bytes(const Mesh& mesh, const std::vector<LineSet>& lines = {},
                      const GlbOptions& options = {});

// Atomically; throws InputError naming the path.
void write_glb(const std::string& path, const Mesh& mesh, const std::vector<LineSet>& lines = {},
               const GlbOptions& options = {});

}  // namespace isochor
