// Compiled for AVX2 and fused multiply-add; reached only where the processor has them.
#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>

#include "isochor/volume/contraction_stages.h"

namespace isochor::internal {
namespace {

struct Avx2Lanes {
  using Vector = __m256d;
  static Vector load(const Pack& pack) { return _mm256_load_pd(pack.lane); }
  static Vector load_once(const Pack& pack) {
    Vector a = load(pack);
    asm("" : "+x"(a));  // else the compiler reads memory once for each use: loads are scarce here
    return a;
  }
  static void store(Pack& pack, Vector a) { _mm256_store_pd(pack.lane, a); }
  static Vector broadcast(double a) { return _mm256_set1_pd(a); }
  static Vector zero() { return _mm256_setzero_pd(); }
  static Vector difference(Vector a, Vector b) { return _mm256_sub_pd(a, b); }
  static Vector add_product(Vector a, Vector b, Vector c) { return _mm256_fmadd_pd(a, b, c); }
  static Vector subtract_product(Vector a, Vector b, Vector c) { return _mm256_fnmadd_pd(a, b, c); }
};

}  // namespace

Stages avx2_stages(Columns columns, int u_degree, int v_degree) {
  return stages_of<Avx2Lanes>(columns, u_degree, v_degree);
}

}  // namespace isochor::internal
#else
#include "isochor/volume/contraction_kernel.h"

namespace isochor::internal {

Stages avx2_stages(Columns, int, int) { return {}; }

}  // namespace isochor::internal
#endif
