// The most floating-point operations a second that one thread of this machine does: fused
// multiply-adds on registers alone, four doubles each.
#pragma once

namespace isochor::bench {

// True when the processor has AVX2 and FMA; nothing else here may be called without.
bool has_fma();

// GFLOP/s, an FMA being two; thread-CPU time, best of several runs of some milliseconds.
double fma_peak_gflops();

}  // namespace isochor::bench
