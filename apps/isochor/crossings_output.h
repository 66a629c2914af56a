// What is known of faces that cut through each other, for people and as JSON.
#pragma once

#include <string>

#include "isochor/io/value.h"
#include "isochor/step/solid_model.h"

namespace isochor::app {

Value to_value(const SolidModel& solid, const CrossingsAccount& account);
// One line with the counts; findings name what was found.
std::string crossings_text(const SolidModel& solid, const CrossingsAccount& account);

}  // namespace isochor::app
