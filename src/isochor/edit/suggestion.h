// A first edit for a model nobody has edited yet: at its freest place.
#pragma once

#include <optional>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/edit/edit_script.h"
#include "isochor/edit/edit_session.h"

namespace isochor {

struct SuggestionOptions {
  double relative_pull = 0.01;  // length of the pull over the model's diagonal
  int enough_rings = 3;         // free coefficients on every side that make a place good
  int most_spans = 96;          // never refine a patch beyond this
  Continuity continuity = Continuity::kMeasured;  // what the edit keeps; C0 may make creases
};

// An edit that pulls the freest place outwards with the volume kept; patches are tried from the
// largest, each as it is and then with knots inserted until a place is `enough_rings` away from
// everything that must not move. The edit has been solved once, so it is known to work.
// Empty when no patch has such a place.
std::optional<Edit> suggest_edit(const PatchModel& model, const Surroundings& surroundings,
                                 const SuggestionOptions& options = {});

}  // namespace isochor
