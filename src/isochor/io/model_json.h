// Models as `.isochor.json` (CONTRACT, "Model").
//
// Laws: (1) write then read gives the same model, bit for bit;
//       (2) the table of points keeps its order and its size.
#pragma once

#include <string>

#include "isochor/bspline/patch_model.h"

namespace isochor {

// Parses a model; `file` is only used in errors. Joins are found and freedoms derived.
// Throws InputError naming the place in the file and the value.
PatchModel parse_model(const std::string& text, const std::string& file);

// The text of a model file.
std::string format_model(const PatchModel& model);

}  // namespace isochor
