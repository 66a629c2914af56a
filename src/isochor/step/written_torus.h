// Tori in STEP files about to be written. Internal to `step`.
//
// OpenCASCADE's STEP writer replaces a torus that meets itself (its tube is wider than its hole, as
// on many screw heads) by the revolution of an approximated circle, some 1e-7 away. The face's own
// torus is exact, and its parameters mean the same point, so parameter curves stay as they are.
#pragma once

#include <XSControl_WorkSession.hxx>

#include "isochor/step/document.h"

namespace isochor::internal {

// Gives each such face of a transferred model its torus back, and takes what replaced it out of the
// model. Faces whose axis is not, bit for bit, the one the writer used stay as they are.
void restore_tori(const Handle(XSControl_WorkSession) & writer, const Document& document);

}  // namespace isochor::internal
