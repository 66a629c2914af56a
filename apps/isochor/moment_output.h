// Moments and sections as `isochor volume --moments --section` prints them.
#pragma once

#include "isochor/io/value.h"
#include "isochor/volume/moments.h"
#include "isochor/volume/section.h"
#include "model_source.h"

namespace isochor::app {

// Moments of a closed model. InputError when it has none.
Moments moments_of(const LoadedModel& loaded);

// The value of the key "moments".
Value to_value(const Moments& moments);
void print_moments(const Common& common, const Moments& moments, const std::string& unit);

// InputError unless the four numbers are a plane.
void require_plane(const std::vector<double>& plane);
// The section of a closed model by this plane: of its patches where they are the whole model, else
// as the reader of the CAD file measured it.
Section section_of(const LoadedModel& loaded, const std::vector<double>& plane);

// The value of the key "section".
Value to_value(const Section& section);
void print_section(const Common& common, const Section& section, const std::string& unit);

}  // namespace isochor::app
