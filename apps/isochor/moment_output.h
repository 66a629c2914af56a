// What `isochor volume --moments --section --below` measures and prints.
#pragma once

#include "isochor/io/value.h"
#include "isochor/volume/below.h"
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

// The plane of --below; empty for an empty text. InputError for what is no plane.
std::optional<ClosingPlane> parse_below(const std::string& text);
// What a closed model, or one closed by planes, has below: of its patches where they are the whole
// model, else as the reader of the CAD file measured it. InputError when the planes do not go
// together.
PartBelow below_of(const LoadedModel& loaded, const ClosingPlane& plane);

// The value of the key "below".
Value to_value(const PartBelow& part, const LoadedModel& loaded);
void print_below(const Common& common, const PartBelow& part, const LoadedModel& loaded);

}  // namespace isochor::app
