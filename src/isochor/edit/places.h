// Points of a surface as edits name them, found on a model.
#pragma once

#include <string>

#include "isochor/bspline/patch_model.h"
#include "isochor/edit/edit_script.h"

namespace isochor {

struct SurfacePlace {
  int patch = 0;
  Uv uv;
};

// A place given by parameters or as the nearest point (not a coefficient: PreconditionError).
// Throws InputError about `where` when the patch is unknown or the point is not on it. Cost of
// "near": closest_point.
SurfacePlace surface_place(const PatchModel& model, const Place& place, const std::string& where);

// "(0.5, 0.25)", six digits.
std::string text_of(const Uv& uv);

}  // namespace isochor
