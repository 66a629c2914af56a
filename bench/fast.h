// The library's contraction as the benchmarks call it: the only place that knows its interface.
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/volume/contraction.h"

namespace isochor::bench {

// Which instructions the contraction may use.
enum class Instructions { kBest, kPlain };

// False when the library offers no such choice, so that the same code would be measured twice.
bool can_choose(Instructions instructions);
// False when the library computes on one thread whatever it is asked for.
bool can_choose_threads();

class Fast {
 public:
  explicit Fast(const PatchModel& model, Instructions instructions = Instructions::kBest,
                int threads = 1);
  ValueAndGradient run(const std::vector<Vec3>& points) const;

 private:
  VolumeContraction contraction_;
};

}  // namespace isochor::bench
