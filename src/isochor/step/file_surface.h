// The B-spline surface of a face as the STEP file states it. Internal to `step`.
//
// OpenCASCADE's reader makes clamped closed surfaces periodic and so changes their poles; the
// file's own entities do not change.
#pragma once

#include <map>
#include <optional>

#include "isochor/bspline/surface.h"
#include "isochor/step/document.h"

namespace isochor::internal {

// Empty when the document is not STEP, the entity cannot be found, or it is not a B-spline with
// knots. `k` counts from 0.
std::optional<Surface> file_surface(const Document& document, int k);

// The file's surfaces of the faces that OpenCASCADE changed when it read them, by face number from
// 0: the same degrees and domains, other poles.
using FileSurfaces = std::map<int, Surface>;
FileSurfaces changed_by_reader(const Document& document);

// Gives a face of a STEP model that is about to be written the numbers of `surface`. False when the
// face is not found or its surface has another size: then it stays as it is.
bool restore_numbers(const Handle(XSControl_WorkSession) & writer, const TopoDS_Face& face,
                     const Surface& surface);

}  // namespace isochor::internal
