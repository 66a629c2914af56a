// The library's contraction as the benchmarks call it: the only place that knows its interface.
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/volume/contraction.h"

namespace isochor::bench {

// Which instructions the contraction may use.
enum class Instructions { kBest, kPlain };

class Fast {
 public:
  explicit Fast(const PatchModel& model, Instructions instructions = Instructions::kBest,
                int threads = 1);
  // Overwrites the result, whose memory is used again.
  void run(const std::vector<Vec3>& points, ValueAndGradient& result) const;
  ValueAndGradient run(const std::vector<Vec3>& points) const;

 private:
  VolumeContraction contraction_;
  int threads_;
};

}  // namespace isochor::bench
