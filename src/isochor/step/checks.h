// What may be said of an edited shape before it is written, and of a file after it is read back.
// Internal to `step`. All texts are reasons in words; empty means nothing to object.
#pragma once

#include <string>

#include "isochor/step/document.h"
#include "isochor/step/gaps.h"
#include "isochor/step/solid_model.h"

namespace isochor::internal {

// Three digits, for messages; small values keep theirs (1.2e-10, not 0.000000).
std::string number_text(double value);

// Compares a rebuilt shape with its input. Reading a STEP file again repairs an invalid solid by
// larger tolerances, so this must happen before anything is written. Tolerances and gaps may grow
// to `trim_tolerance`, the one that the user gave for moved trims.
std::string objection_to_rebuilt(const ShapeFacts& before, const ShapeFacts& rebuilt,
                                 double trim_tolerance = 0.0);

// The same edge by edge: a new gap must not hide behind a larger old one elsewhere. An edge may use
// its own tolerance, which has not changed but for moved trims.
std::string objection_to_gaps(const TopoDS_Shape& before, const TopoDS_Shape& rebuilt);

// Says when the largest tolerance is larger than it was, and than `allowed`; reading a file again
// may enlarge it.
std::string tolerance_growth(const ShapeFacts& written, const ShapeFacts& reread,
                             double allowed = 0.0);

// Files store no ranges of edges: a reader finds anew where they end, and gaps may differ. `beyond`
// is what lies outside the tolerance that the shape had, `inside` what grew within it.
struct GapGrowth {
  std::string inside, beyond;
};
GapGrowth gap_growth(const ShapeFacts& written, const ShapeFacts& reread);

// Compares what was read back with what was written, tolerances and gaps aside.
std::string objection_to_reread(const ShapeFacts& written, const ShapeFacts& reread, bool labels);

}  // namespace isochor::internal
