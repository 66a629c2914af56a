// The step along a line that makes a wanted change of volume.
#pragma once

#include "isochor/volume/volume_form.h"

namespace isochor {

// The real root of c.change(s) = target that is nearest to zero; not finite when there is none.
double nearest_root(const LineCubic& c, double target);

}  // namespace isochor
