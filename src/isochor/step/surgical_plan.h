// From a rebuilt document to the lines of its STEP file. Internal to `step` (OpenCASCADE types).
#pragma once

#include <vector>

#include "isochor/step/document.h"
#include "isochor/step/rebuild_plan.h"
#include "isochor/step/surgical.h"

namespace isochor::internal {

// What the plans of `rebuild` mean for the entities that `document` was read from. The document may
// have been rebuilt since.
SurgicalEdit surgical_edit(const Document& document, const std::vector<RebuildPlan>& plans);

}  // namespace isochor::internal
