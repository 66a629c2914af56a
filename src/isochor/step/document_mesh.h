// Meshes of a document that was read. Internal to the step layer (OpenCASCADE types).
#pragma once

#include "isochor/step/document.h"
#include "isochor/step/solid_mesh.h"

namespace isochor::internal {

// Leaves a triangulation in the document's shape.
SolidMesh document_mesh(const Document& document, const SolidMeshOptions& options = {});

}  // namespace isochor::internal
