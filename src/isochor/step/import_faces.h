// Compares what a STEP file states with what OpenCASCADE returned. Internal to `step`.
#pragma once

#include "isochor/step/document.h"

namespace isochor::internal {

// Completes the account of a document that has been read and indexed; reads the text of a STEP file
// a second time. Areas are not looked at.
void account_for_import(Document& document);

}  // namespace isochor::internal
