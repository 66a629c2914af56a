// Wavefront OBJ: text, with all digits of every coordinate.
//
// Laws:
//  (1) a reader that parses decimal numbers correctly gets back the same doubles;
//  (2) parse_obj(obj_text(mesh)) has the triangles, groups apart, and the positions of `mesh`.
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

// Positions and faces of an OBJ text; faces of more than three corners become fans of triangles.
// Corners may be v, v/vt, v//vn or v/vt/vn, numbers negative (counted from the end). Texture
// coordinates, normals, names, groups and materials are skipped: pictures make their own normals.
// Throws InputError(file, "line 7", reason) for everything else, also for a mesh without faces.
Mesh parse_obj(const std::string& text, const std::string& file);

}  // namespace isochor
