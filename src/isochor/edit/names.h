// Finding patches by the names users write: name, handle ("face:12") or alias ("#1234").
#pragma once

#include <string>

#include "isochor/bspline/patch_model.h"

namespace isochor {

// The index of the patch called `name`. Throws InputError when there is none (naming what there is)
// or several (listing the candidates).
int find_patch(const PatchModel& model, const std::string& name);

}  // namespace isochor
