// What became of a file on its way in, for people and as JSON.
#pragma once

#include "commands.h"
#include "isochor/io/value.h"
#include "isochor/step/import_account.h"

namespace isochor::app {

Value to_value(const ImportAccount& account);
// A few lines; of what went as it should, only the counts.
void print_import(const Common& common, const ImportAccount& account);
// What `check` finds: empty for a file that came in whole.
std::vector<std::string> import_findings(const ImportAccount& account);

}  // namespace isochor::app
