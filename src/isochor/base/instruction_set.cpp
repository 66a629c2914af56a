#include "isochor/base/instruction_set.h"

namespace isochor {
namespace {

bool has_avx2() {
#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
#else
  return false;
#endif
}

}  // namespace

InstructionSet best_instruction_set() {
  static const InstructionSet best = has_avx2() ? InstructionSet::kAvx2 : InstructionSet::kPortable;
  return best;
}

const char* to_string(InstructionSet set) {
  return set == InstructionSet::kAvx2 ? "avx2+fma" : "portable";
}

}  // namespace isochor
