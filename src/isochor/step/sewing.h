// Sewing: a file of loose faces or open shells becomes shells and solids.
//
// Faces are joined where their edges run together within kCoincident times the diagonal (real files
// give the same answer from a hundredth to a thousand times that). Closed shells become solids,
// oriented outwards; none is taken for the hollow of another.
//
// The file's own shape stays when there is nothing to gain: it has a solid, no edge is free, or as
// many edges stay free as there were. It stays, and the account says why, where edges run together
// but sewing would
//  - mix the order of faces, because shells take turns in the file;
//  - need a tolerance larger than the file has and larger than 2 * kCoincident * diagonal;
//  - have to choose which two of three faces meet at an edge;
//  - change a surface, or give an invalid shape;
//  - take an assembly apart, or a part that stands in several places.
//
// Laws (tests of those names in tests/step/sewing_test.cpp):
//  (1) faces are numbered, and stand in the shape, in the order of the file, and keep surfaces,
//      names and colours; faces without area are dropped, and said so;
//  (2) a box of loose faces becomes a solid of its volume, whichever way its faces were turned;
//  (3) what is closed already, or gains nothing, is not touched.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include "isochor/step/document.h"

namespace isochor::internal {

// Replaces shape, faces, names, labels and origins when something is gained; fills
// `account.sewing` and adds its lines to the notices.
void sew(Document& document);

}  // namespace isochor::internal
