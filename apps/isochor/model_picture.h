// Pictures of models: what `edit --picture` and `render` write.
#pragma once

#include <string>
#include <vector>

#include "isochor/edit/edit_session.h"
#include "isochor/io/image.h"
#include "isochor/io/mesh.h"
#include "model_source.h"

namespace isochor::app {

// Before, after and signed displacement side by side.
Image draw_edit(const LoadedModel& before, const EditSession& session,
                const std::vector<Certificate>& certificates, const Common& common);

// Throws InputError unless a PNG file can be written there.
void require_picture(const std::string& path);

// Triangles and borders of a whole model, also of faces that are no patches.
struct ModelMesh {
  Mesh mesh;
  std::vector<LineSet> lines;
};
ModelMesh mesh_of(const LoadedModel& model, const Common& common);

}  // namespace isochor::app
