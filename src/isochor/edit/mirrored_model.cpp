#include "isochor/edit/mirrored_model.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"

namespace isochor {
namespace {

// The image of a patch; its names are not those that users may write.
Patch image_of(Patch patch, int points) {
  patch.handle = "the mirror image of " + patch.handle;
  patch.name.clear();
  patch.aliases.clear();
  patch.reversed = !patch.reversed;
  for (int& id : patch.points) id += points;
  return patch;
}

void add_images(const PatchModel& half, int axis, PatchModel& whole) {
  const int n = static_cast<int>(half.points.size());
  const int m = static_cast<int>(half.patches.size());
  for (Vec3 p : half.points) {
    p[axis] = -p[axis];
    whole.points.push_back(p);
  }
  for (const Patch& patch : half.patches) whole.patches.push_back(image_of(patch, n));
  for (const auto& [a, b] : half.ties) whole.ties.emplace_back(a + n, b + n);
  for (Join join : half.joins) {
    join.a.patch += m;
    join.b.patch += m;
    whole.joins.push_back(join);
  }
  for (LockedSide side : half.locked_sides) {
    side.side.patch += m;
    whole.locked_sides.push_back(side);
  }
  for (const auto& [point, reason] : half.fixed_points) {
    whole.fixed_points.emplace_back(point + n, reason);
  }
}

}  // namespace

std::vector<SideRef> free_sides(const PatchModel& model) {
  std::vector<SideRef> free;
  const PointClasses classes = point_classes(model);
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    for (Side side : kSides) {
      const SideRef ref{q, side};
      const bool joined = std::any_of(model.joins.begin(), model.joins.end(),
                                      [&](const Join& j) { return j.a == ref || j.b == ref; });
      const bool locked = std::any_of(model.locked_sides.begin(), model.locked_sides.end(),
                                      [&](const LockedSide& other) { return other.side == ref; });
      const Patch& patch = model.patches[static_cast<size_t>(q)];
      if (!joined && !locked && !is_collapsed(patch, side, classes)) free.push_back(ref);
    }
  }
  return free;
}

PatchModel mirrored_model(const PatchModel& half, int axis) {
  PatchModel whole = half;
  if (whole.joins.empty()) whole.joins = find_joins(whole);
  PatchModel source = whole;
  add_images(source, axis, whole);
  const int n = static_cast<int>(half.points.size());
  const int m = static_cast<int>(half.patches.size());
  const double tolerance = 0.5 * kCoincident * diagonal(half);
  std::vector<SideRef> sides;
  for (const SideRef& ref : free_sides(source)) {
    const Patch& patch = half.patches[static_cast<size_t>(ref.patch)];
    const auto indices = side_indices(patch, ref.side);
    const bool in_plane = std::all_of(indices.begin(), indices.end(), [&](const auto& at) {
      const auto id = static_cast<size_t>(patch.point(at.first, at.second));
      return std::abs(half.points[id][axis]) <= tolerance;
    });
    if (!in_plane) continue;
    sides.push_back(ref);
    for (const auto& [i, j] : indices) {
      const int id = patch.point(i, j);
      whole.ties.emplace_back(id, id + n);
    }
  }
  for (const SideRef& ref : sides) {
    whole.joins.push_back(measure_join(whole, ref, {ref.patch + m, ref.side}, false));
  }
  derive_locks(whole);
  return whole;
}

}  // namespace isochor
