// A patch model as a document of OpenCASCADE's. Internal to `step`.
#pragma once

#include <string>

#include "isochor/bspline/patch_model.h"
#include "isochor/step/document.h"

namespace isochor::internal {

// See write_patch_model.
Document patch_document(const PatchModel& model, const std::string& name);

}  // namespace isochor::internal
