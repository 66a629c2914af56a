// The picture of a check: edges by how smoothly their faces meet, findings marked.
#pragma once

#include <string>
#include <vector>

#include "isochor/io/image.h"
#include "isochor/volume/findings.h"
#include "model_source.h"

namespace isochor::app {

Image draw_check(const LoadedModel& loaded, const CheckedModel& subject,
                 const std::vector<Finding>& findings, const Common& common);

}  // namespace isochor::app
