// How a child process (see bridge.h) tells its parent how far its work has come. Internal to
// `step`.
//
// A process does one job, so what is kept here belongs to the process. Outside a child nothing
// happens: the same functions run in tests without one.
//
// Laws:
//  (1) fractions never go back, and lie in [0, 1];
//  (2) few are sent: a new step, the end, or half a percent more after a hundredth of a second.
#pragma once

#include <functional>
#include <string_view>

namespace isochor::internal {

// `fraction` counts within the innermost ProgressPart.
void tell_progress(double fraction, std::string_view step);

// While it lives, fractions from 0 to 1 stand for those from `begin` to `end` of the part around
// it.
class ProgressPart {
 public:
  ProgressPart(double begin, double end);
  ~ProgressPart();
  ProgressPart(const ProgressPart&) = delete;
  ProgressPart& operator=(const ProgressPart&) = delete;

 private:
  double outer_begin_, outer_end_;
};

// Where progress goes from now on; what was told before is forgotten. Used by the bridge and tests.
using ProgressSink = std::function<void(double fraction, std::string_view step)>;
void set_progress_sink(ProgressSink sink);

}  // namespace isochor::internal
