// `.isochor.json` text of patches; equal poles become one point, so that patches join there.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "isochor/bspline/surface.h"

namespace make_data {

using NamedSurfaces = std::vector<std::pair<std::string, isochor::Surface>>;

std::string model_text(const NamedSurfaces& surfaces);

}  // namespace make_data
