// Which instructions a numeric kernel may use.
//
// Results are the same to the bit for one instruction set, on every machine and for any number of
// threads. Between instruction sets they differ by rounding, because fused multiply-add rounds once
// where a product and a sum round twice.
#pragma once

namespace isochor {

enum class InstructionSet {
  kPortable,  // what the compiler assumes everywhere: products and sums round apart
  kAvx2,      // AVX2 and fused multiply-add, x86-64 only
};

// The best that this processor has and this library was built for; asked once.
InstructionSet best_instruction_set();

// "portable" or "avx2+fma".
const char* to_string(InstructionSet set);

}  // namespace isochor
