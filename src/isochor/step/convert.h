// Changing the format of a model: STEP, IGES, BREP, and patch models in memory.
//
// Laws (as for write_edited): the output is read back by a fresh process and compared before it is
// put in its place; B-spline faces keep every bit, and a notice names those that a format states in
// another form; what it cannot carry is a notice too.
#pragma once

#include <string>

#include "isochor/bspline/patch_model.h"
#include "isochor/step/solid_model.h"

namespace isochor {

// Formats go by the extensions. `rebuilt` of the report equals `before`; `written` is false, with
// the reason in `refusal`, when the output would not be the same shape. An input that is not valid
// is converted as it is. Throws InputError when the input cannot be read or the output cannot be
// created. STEP to STEP copies the lines unless `rewrite`: then OpenCASCADE writes the file anew.
WriteReport convert_file(const std::string& input, const std::string& output,
                         const BridgeLimits& limits = {}, const Watch& watch = {},
                         bool rewrite = false);

// Writes patches as faces, sewn where their sides coincide; a closed result is a solid. Names of
// patches become names of faces. `name` stands for the model in errors. Throws InputError naming
// the patch that is no valid face, or the unit that CAD formats do not know.
WriteReport write_patch_model(const PatchModel& model, const std::string& name,
                              const std::string& output, const BridgeLimits& limits = {},
                              const Watch& watch = {});

// The patches of a solid as a model of its own, for `.isochor.json`: points, patches and ties,
// without what is known from the file. Throws InputError naming a face that is trimmed or not a
// B-spline: that format holds whole patches only.
PatchModel whole_patches(const SolidModel& solid);

}  // namespace isochor
