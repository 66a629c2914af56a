// Sewing: a file of loose faces or open shells becomes shells and solids.
//
// Faces are joined where their edges run together within a tolerance of 1e-6 of the diagonal (real
// files give the same answer from 1e-8 to 1e-3). Closed shells become solids, oriented outwards.
// The file's own shape stays when nothing is gained: when it has a solid, when no edge is free, or
// when sewing leaves as many free edges as there were.
//
// Laws (tests of those names in tests/step/sewing_test.cpp):
//  (1) faces keep their order, names and colours; faces without area are dropped, and said so;
//  (2) a box of loose faces becomes a solid of its volume, whichever way its faces were turned;
//  (3) what is closed already, or gains nothing, is not touched.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include "isochor/step/document.h"

namespace isochor::internal {

// Replaces shape, faces, names and labels; adds notices; sets `sewn` when something was gained.
void sew(Document& document);

}  // namespace isochor::internal
