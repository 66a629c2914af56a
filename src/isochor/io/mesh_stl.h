// Binary STL.
//
// The format has single precision and no unit; coordinates are rounded to nearest. Triangles that
// have no area after rounding are kept, with a zero normal.
#pragma once

#include <string>

#include "isochor/io/mesh.h"

namespace isochor {

// The bytes of the file. Throws PreconditionError when a coordinate is beyond single precision.
std::string stl_bytes(const Mesh& mesh);

// Atomically; throws InputError naming the path.
void write_stl(const std::string& path, const Mesh& mesh);

}  // namespace isochor
