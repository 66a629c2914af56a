#include "fma_peak.h"

#include <immintrin.h>

#include <algorithm>

#include "timing.h"

namespace isochor::bench {
namespace {

constexpr int kRounds = 2000000;

// Twelve chains of dependent operations, in twelve registers: enough to fill two units of latency
// four or five. The empty asm statement keeps the compiler from merging or removing anything, and
// its "x" constraints keep the chains in registers.
double twelve_chains() {
  const __m256d factor = _mm256_set1_pd(0.999999), term = _mm256_set1_pd(1e-6);
  __m256d a = term, b = term, c = term, d = term, e = term, f = term;
  __m256d g = term, h = term, i = term, j = term, k = term, l = term;
  for (int round = 0; round < kRounds; ++round) {
    a = _mm256_fmadd_pd(a, factor, term);
    b = _mm256_fmadd_pd(b, factor, term);
    c = _mm256_fmadd_pd(c, factor, term);
    d = _mm256_fmadd_pd(d, factor, term);
    e = _mm256_fmadd_pd(e, factor, term);
    f = _mm256_fmadd_pd(f, factor, term);
    g = _mm256_fmadd_pd(g, factor, term);
    h = _mm256_fmadd_pd(h, factor, term);
    i = _mm256_fmadd_pd(i, factor, term);
    j = _mm256_fmadd_pd(j, factor, term);
    k = _mm256_fmadd_pd(k, factor, term);
    l = _mm256_fmadd_pd(l, factor, term);
    __asm__ volatile(""
                     : "+x"(a), "+x"(b), "+x"(c), "+x"(d), "+x"(e), "+x"(f), "+x"(g), "+x"(h),
                       "+x"(i), "+x"(j), "+x"(k), "+x"(l));
  }
  const __m256d sum = a + b + c + d + e + f + g + h + i + j + k + l;
  return sum[0] + sum[1] + sum[2] + sum[3];
}

}  // namespace

bool has_fma() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }

double fma_peak_gflops() {
  volatile double sink = 0.0;
  const double seconds = best_cpu_seconds([&] { sink = twelve_chains(); }, {9, 0.2});
  return 12.0 * 4.0 * 2.0 * kRounds / seconds * 1e-9;
}

}  // namespace isochor::bench
