// Everything Isochor knows about a document that was read (SolidModel), in the process that holds
// the document. Internal to the step layer (OpenCASCADE types).
#pragma once

#include "isochor/step/brep_table.h"
#include "isochor/step/document.h"
#include "isochor/step/solid_model.h"

namespace isochor::internal {

// Throws InputError naming the face when one of options.convert does not exist or cannot be
// converted.
SolidModel document_model(const Document& document, const ReadOptions& options = {});

// "#1234", "wing/face:3": other names of every face, in the document's order.
std::vector<std::vector<std::string>> face_aliases(const Document& document);

}  // namespace isochor::internal
