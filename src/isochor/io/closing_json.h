// Closing planes as edits files write them: [{"symmetry": "y"}, {"plane": {"normal", "offset"}}].
#pragma once

#include <vector>

#include "isochor/io/json_reader.h"
#include "isochor/volume/flux_field.h"

namespace isochor::internal {

// Throws InputError naming the key.
std::vector<ClosingPlane> parse_close(const JsonValue& list);
Json format_close(const std::vector<ClosingPlane>& planes);

}  // namespace isochor::internal
