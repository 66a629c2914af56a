// Joins whose sides carry one curve in different bases.
#include "isochor/bspline/common_basis.h"
#include "isochor/bspline/joins.h"

namespace isochor {

Join measure_common_join(const PatchModel& model, const std::vector<Vec3>& at, const SideRef& a,
                         const SidePart& part_a, const SideRef& b, const SidePart& part_b,
                         bool opposed) {
  Join join;
  join.a = a;
  join.b = b;
  join.part_a = part_a;
  join.part_b = part_b;
  join.opposed = opposed;
  for (const SideRef& ref : {a, b}) {
    const Patch& patch = model.patches[static_cast<size_t>(ref.patch)];
    const KnotVector& across = knots_of(patch, across_direction(ref.side));
    if (is_begin_side(ref.side) ? across.clamped_begin() : across.clamped_end()) continue;
    join.mismatch = "the knots of " + label_of(model, ref) + " are not clamped";
    return join;
  }
  const std::optional<CommonPair> pair = common_pair(model, at, join);
  if (!pair) {
    join.mismatch = "the knots of the two sides are too close to each other";
    return join;
  }
  const Join measured = measure_join(pair->model, diagonal(model), pair->a, pair->b, false);
  join.common = measured.matching;
  join.mismatch = measured.mismatch;
  join.max_gap = measured.max_gap;
  join.max_angle_rad = measured.max_angle_rad;
  join.max_curvature_jump = measured.max_curvature_jump;
  join.smoothness = measured.smoothness;
  return join;
}

Join measure_join(const PatchModel& model, const std::vector<Vec3>& at, const Join& join) {
  if (!join.common) return measure_join(model, at, join.a, join.b, join.opposed);
  return measure_common_join(model, at, join.a, join.part_a, join.b, join.part_b, join.opposed);
}

}  // namespace isochor
