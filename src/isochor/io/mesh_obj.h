// Wavefront OBJ: text, with all digits of every coordinate.
//
// Law: a reader that parses decimal numbers correctly gets back the same doubles.
#pragma once

#include <string>
#include <vector>

#include "isochor/io/mesh.h"

namespace isochor {

// The text of the file. `group_names[g]` is written for group g ("face:3"); missing ones become
// "group_<g>". Characters that would break a line or a name become '_'.
std::string obj_text(const Mesh& mesh, const std::vector<std::string>& group_names = {});

// Atomically; throws InputError naming the path.
void write_obj(const std::string& path, const Mesh& mesh,
               const std::vector<std::string>& group_names = {});

}  // namespace isochor
