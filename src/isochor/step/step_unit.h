// The length unit that a STEP file states. Internal to `step`.
#pragma once

#include <StepData_StepModel.hxx>
#include <string>
#include <vector>

#include "isochor/step/length_unit.h"

namespace isochor::internal {

// The unit of the representation contexts; a notice is added when they disagree or none states one.
LengthUnit step_unit(const StepData_StepModel& model, std::vector<std::string>& notices);

}  // namespace isochor::internal
