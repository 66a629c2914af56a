#include "fast.h"

#include "isochor/base/error.h"

namespace isochor::bench {

bool can_choose(Instructions instructions) { return instructions == Instructions::kBest; }
bool can_choose_threads() { return false; }

Fast::Fast(const PatchModel& model, Instructions instructions, int threads) : contraction_(model) {
  ISOCHOR_REQUIRE(can_choose(instructions), static_cast<int>(instructions));
  ISOCHOR_REQUIRE(threads == 1 || can_choose_threads(), threads);
}

ValueAndGradient Fast::run(const std::vector<Vec3>& points) const {
  return contraction_.value_and_gradient(points);
}

}  // namespace isochor::bench
