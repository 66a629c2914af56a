// Changing the format of a model: STEP, IGES, BREP, and `.isochor.json` models in memory.
//
// Laws (see write_edited): the output is read back by a fresh process and compared before it is put
// in its place; B-spline faces keep every bit; what a format cannot carry is a notice.
#pragma once

#include <string>

#include "isochor/bspline/patch_model.h"
#include "isochor/step/solid_model.h"

namespace isochor {

// Formats go by the extensions. `rebuilt` of the report equals `before`. Throws InputError when the
// input cannot be read or the output cannot be created; `written` is false when the output would
// not be the same shape.
WriteReport convert_file(const std::string& input, const std::string& output,
                         const BridgeLimits& limits = {});

// Writes patches as faces, sewn where the model joins them (same points, or ties that coincide).
// `name` is used in errors. Names of patches become names of faces. The unit must be one that
// OpenCASCADE knows. Throws InputError naming the patch or the unit.
WriteReport write_patch_model(const PatchModel& model, const std::string& name,
                              const std::string& output, const BridgeLimits& limits = {});

}  // namespace isochor
