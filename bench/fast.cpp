#include "fast.h"

namespace isochor::bench {
namespace {

InstructionSet set_for(Instructions instructions) {
  return instructions == Instructions::kBest ? best_instruction_set() : InstructionSet::kPortable;
}

}  // namespace

Fast::Fast(const PatchModel& model, Instructions instructions, int threads)
    : contraction_(model, set_for(instructions)), threads_(threads) {}

void Fast::run(const std::vector<Vec3>& points, ValueAndGradient& result) const {
  contraction_.value_and_gradient(points, 0.0, threads_, result);
}

ValueAndGradient Fast::run(const std::vector<Vec3>& points) const {
  ValueAndGradient result;
  run(points, result);
  return result;
}

}  // namespace isochor::bench
