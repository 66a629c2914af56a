#include "isochor/edit/skin_change.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/smoothness.h"

namespace isochor {
namespace {

void add_angle(SkinChange& change, double before, double after) {
  change.angle_rad = std::max(change.angle_rad, std::abs(after - before));
}

void add_curvature(SkinChange& change, double before, double after) {
  change.curvature = std::max(change.curvature, std::abs(after - before));
}

void add_knot_lines(SkinChange& change, const Surface& before, const Surface& after, double size) {
  for (Direction direction : {Direction::kU, Direction::kV}) {
    const std::vector<KnotLine> lines = interior_smoothness(before, direction, size);
    const std::vector<KnotLine> now = interior_smoothness(after, direction, size);
    const int degree = knots_of(before, direction).degree();
    for (size_t k = 0; k < lines.size(); ++k) {
      const KnotLine& line = lines[k];
      const int order = protected_order(line.measured, degree);
      if (line.measured <= line.guaranteed || order <= degree - line.multiplicity) continue;
      ++change.knot_lines;
      add_angle(change, line.max_angle_rad, now[k].max_angle_rad);
      if (order >= 2) add_curvature(change, line.max_curvature_jump, now[k].max_curvature_jump);
    }
  }
}

void add_poles(SkinChange& change, const Surface& before, const Surface& after, double size) {
  for (Side side : kSides) {
    const PoleSide pole = pole_side(before, side, size);
    if (!pole.collapsed || pole.smoothness == Smoothness::kSharp) continue;
    ++change.poles;
    add_angle(change, pole.max_angle_rad, pole_side(after, side, size).max_angle_rad);
  }
}

// Equations may keep less than what was measured: quadratics have no room for curvature.
int kept_order(const PatchModel& model, int join) {
  for (const SmoothRelation& relation : model.relations) {
    if (relation.join == join) return relation.order;
  }
  return order_of(model.joins[static_cast<size_t>(join)].smoothness);
}

}  // namespace

SkinChange skin_change(const PatchModel& before, const PatchModel& after,
                       const std::vector<bool>& moved) {
  ISOCHOR_REQUIRE(moved.size() == before.patches.size(), moved.size());
  const double size = diagonal(before);
  SkinChange change;
  for (int q = 0; q < static_cast<int>(moved.size()); ++q) {
    if (!moved[static_cast<size_t>(q)]) continue;
    const Surface was = before.surface(q);
    const Surface is = before.surface(q, after.points);
    add_knot_lines(change, was, is, size);
    add_poles(change, was, is, size);
  }
  for (int k = 0; k < static_cast<int>(before.joins.size()); ++k) {
    const Join& join = before.joins[static_cast<size_t>(k)];
    const bool touched =
        moved[static_cast<size_t>(join.a.patch)] || moved[static_cast<size_t>(join.b.patch)];
    if (!touched || join.smoothness == Smoothness::kSharp) continue;
    ++change.joins;
    const Join now = measure_join(before, after.points, join.a, join.b, join.opposed);
    add_angle(change, join.max_angle_rad, now.max_angle_rad);
    if (kept_order(before, k) >= 2) {
      add_curvature(change, join.max_curvature_jump, now.max_curvature_jump);
    }
  }
  return change;
}

}  // namespace isochor
