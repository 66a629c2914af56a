// How a mathematical question ended. "Don't know" is never rounded to yes or no.
#pragma once

#include <string_view>

namespace isochor {

enum class Outcome {
  kDone,         // the constraints hold, the result was delivered
  kInfeasible,   // proven: no admissible change satisfies the constraints
  kUndecided,    // not found, and not proven impossible
  kConflicting,  // linear constraints contradict each other; the culprits are named
  kRefused,      // possible perhaps, but not without breaking a promise; the reason is named
  kCancelled,    // stopped by the user
};

// The name used in reports: "done", "infeasible", ...
constexpr std::string_view name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::kDone:
      return "done";
    case Outcome::kInfeasible:
      return "infeasible";
    case Outcome::kUndecided:
      return "undecided";
    case Outcome::kConflicting:
      return "conflicting";
    case Outcome::kRefused:
      return "refused";
    case Outcome::kCancelled:
      return "cancelled";
  }
  return "unknown";
}

}  // namespace isochor
