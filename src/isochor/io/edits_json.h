// Edit scripts as JSON (CONTRACT, "Edits").
#pragma once

#include <string>

#include "isochor/edit/edit_script.h"

namespace isochor {

// Parses an edit script; `file` is only used in errors. Throws InputError naming the place in the
// file and the value; keys and values that belong to a later version are refused by name.
EditScript parse_edits(const std::string& text, const std::string& file);

// The text of an edit script: parse_edits(format_edits(s)) is s.
std::string format_edits(const EditScript& script);

}  // namespace isochor
