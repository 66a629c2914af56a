// A solid as the subject of findings (volume/findings.h).
#pragma once

#include "isochor/step/solid_model.h"
#include "isochor/volume/findings.h"

namespace isochor {

// `closed`: also by planes; the volume is then facts.volume.
CheckedModel checked(const SolidModel& solid, bool closed, const std::string& why_open);

}  // namespace isochor
