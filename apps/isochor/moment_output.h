// Moments as `isochor volume --moments` prints them.
#pragma once

#include "isochor/io/value.h"
#include "isochor/volume/moments.h"
#include "model_source.h"

namespace isochor::app {

// Moments of a closed model. InputError when it has none.
Moments moments_of(const LoadedModel& loaded);

// The value of the key "moments".
Value to_value(const Moments& moments);
void print_moments(const Common& common, const Moments& moments, const std::string& unit);

}  // namespace isochor::app
