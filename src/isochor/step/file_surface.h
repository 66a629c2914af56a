// The B-spline surface of a face as the STEP file states it. Internal to `step`.
//
// OpenCASCADE's reader makes clamped closed surfaces periodic and so changes their poles; the
// file's own entities do not change.
#pragma once

#include <optional>

#include "isochor/bspline/surface.h"
#include "isochor/step/document.h"

namespace isochor::internal {

// Empty when the document is not STEP, the entity cannot be found, or it is not a B-spline with
// knots. `k` counts from 0.
std::optional<Surface> file_surface(const Document& document, int k);

}  // namespace isochor::internal
