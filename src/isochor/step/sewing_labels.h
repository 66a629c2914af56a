// Names, colours and layers of faces that were sewn. Internal to `step`.
#pragma once

#include <utility>
#include <vector>

#include "isochor/step/document.h"

namespace isochor::internal {

// Whether the file places parts in assemblies.
bool is_assembly(const Document& document);

using SewnFace = std::pair<TopoDS_Shape, TopoDS_Shape>;  // of the file, sewn

// Replaces the structure of a document that has one by a single part `shape`. Its faces get the
// names, colours and layers they had, or those of the part that they were in. Fills `names`.
void relabel(Document& document, const TopoDS_Shape& shape, const std::vector<SewnFace>& faces);

}  // namespace isochor::internal
