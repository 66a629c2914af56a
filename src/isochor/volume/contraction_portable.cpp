// The loops for any processor.
#include "isochor/base/error.h"
#include "isochor/volume/contraction_stages.h"

namespace isochor::internal {
namespace {

struct PortableLanes {
  using Vector = Pack;
  static Vector load(const Pack& pack) { return pack; }
  static Vector load_once(const Pack& pack) { return pack; }
  static void store(Pack& pack, const Vector& a) { pack = a; }
  static Vector broadcast(double a) { return {{a, a, a, a}}; }
  static Vector zero() { return {{0.0, 0.0, 0.0, 0.0}}; }
  static Vector difference(const Vector& a, const Vector& b) {
    Vector result;
    for (int l = 0; l < kLanes; ++l) result.lane[l] = a.lane[l] - b.lane[l];
    return result;
  }
  static Vector add_product(const Vector& a, const Vector& b, const Vector& c) {
    Vector sum;
    for (int l = 0; l < kLanes; ++l) sum.lane[l] = c.lane[l] + a.lane[l] * b.lane[l];
    return sum;
  }
  static Vector subtract_product(const Vector& a, const Vector& b, const Vector& c) {
    Vector sum;
    for (int l = 0; l < kLanes; ++l) sum.lane[l] = c.lane[l] - a.lane[l] * b.lane[l];
    return sum;
  }
};

}  // namespace

Stages portable_stages(Columns columns, int u_degree, int v_degree) {
  return stages_of<PortableLanes>(columns, u_degree, v_degree);
}

Stages find_stages(InstructionSet set, Columns columns, int u_degree, int v_degree) {
  if (set == InstructionSet::kPortable) return portable_stages(columns, u_degree, v_degree);
  const Stages stages = avx2_stages(columns, u_degree, v_degree);
  ISOCHOR_REQUIRE(stages.rows != nullptr, "built without AVX2");
  return stages;
}

}  // namespace isochor::internal
