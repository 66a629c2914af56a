// The report of a run (CONTRACT, "Report").
#pragma once

#include <string>
#include <vector>

#include "isochor/edit/certificate.h"
#include "isochor/io/value.h"

namespace isochor {

// One entry of the report's "edits".
Value certificate_value(const Certificate& certificate);

// The outcome of a list of edits: done when all are, else that of the first that is not.
Outcome overall_outcome(const std::vector<Certificate>& certificates);

// The whole report. `extra` holds further top-level keys (files written, checks of the solid).
std::string format_report(const std::vector<Certificate>& certificates, Outcome outcome,
                          const Value::Object& extra);

}  // namespace isochor
