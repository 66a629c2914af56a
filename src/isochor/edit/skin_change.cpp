#include "isochor/edit/skin_change.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"

namespace isochor {
namespace {

void raise(double& largest, double value) { largest = std::max(largest, value); }

void compare_lines(const std::vector<KnotLine>& before, const std::vector<KnotLine>& after,
                   int degree, SkinChange& change) {
  for (size_t k = 0; k < before.size(); ++k) {
    const KnotLine& line = before[k];
    const int order = protected_order(line.measured, degree);
    if (line.measured <= line.guaranteed || order <= degree - line.multiplicity) continue;
    ++change.knot_lines;
    raise(change.angle_rad, std::abs(after[k].max_angle_rad - line.max_angle_rad));
    if (order < 2) continue;
    raise(change.curvature, std::abs(after[k].max_curvature_jump - line.max_curvature_jump));
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

SkinGauge::SkinGauge(const PatchModel& rest)
    : rest_(rest), size_(diagonal(rest)), patches_(rest.patches.size()) {
  // Not those that the model carries: an edit that kept positions only has left them behind.
  for (const Join& join : rest.joins) {
    joins_.push_back(measure_join(rest, rest.points, join));
  }
}

SkinGauge::PatchSkin SkinGauge::patch_skin(const Surface& surface) const {
  PatchSkin skin;
  skin.lines_u = interior_smoothness(surface, Direction::kU, size_);
  skin.lines_v = interior_smoothness(surface, Direction::kV, size_);
  for (size_t s = 0; s < kSides.size(); ++s) {
    skin.sides[s] = pole_side(surface, kSides[s], size_);
  }
  return skin;
}

void SkinGauge::compare_patch(int q, const std::vector<Vec3>& points, SkinChange& change) {
  auto& before = patches_[static_cast<size_t>(q)];
  if (!before) before = patch_skin(rest_.surface(q));
  const PatchSkin after = patch_skin(rest_.surface(q, points));
  const Patch& patch = rest_.patches[static_cast<size_t>(q)];
  compare_lines(before->lines_u, after.lines_u, patch.u_knots.degree(), change);
  compare_lines(before->lines_v, after.lines_v, patch.v_knots.degree(), change);
  for (size_t s = 0; s < kSides.size(); ++s) {
    const PoleSide& pole = before->sides[s];
    if (!pole.collapsed || pole.smoothness == Smoothness::kSharp) continue;
    ++change.poles;
    raise(change.angle_rad, std::abs(after.sides[s].max_angle_rad - pole.max_angle_rad));
  }
}

SkinMeasures SkinGauge::measure(const std::vector<Vec3>& points, const std::vector<bool>& moved) {
  ISOCHOR_REQUIRE(moved.size() == rest_.patches.size(), moved.size());
  SkinMeasures measures;
  auto& [all, change] = measures;
  for (int q = 0; q < static_cast<int>(moved.size()); ++q) {
    if (moved[static_cast<size_t>(q)]) compare_patch(q, points, change);
  }
  for (int k = 0; k < static_cast<int>(joins_.size()); ++k) {
    const Join& stated = rest_.joins[static_cast<size_t>(k)];
    const Join& before = joins_[static_cast<size_t>(k)];
    const bool touched =
        moved[static_cast<size_t>(stated.a.patch)] || moved[static_cast<size_t>(stated.b.patch)];
    const Join after = touched ? measure_join(rest_, points, stated) : before;
    ++all.count;
    raise(all.max_gap, after.max_gap);
    raise(all.max_angle_rad, after.max_angle_rad);
    raise(all.max_curvature_jump, after.max_curvature_jump);
    if (!touched || stated.smoothness == Smoothness::kSharp) continue;
    const double turned = std::abs(after.max_angle_rad - before.max_angle_rad);
    if (stated.smoothness >= Smoothness::kAlmost) raise(all.angle_change_rad, turned);
    ++change.joins;
    raise(change.angle_rad, turned);
    if (kept_order(rest_, k) < 2) continue;
    raise(change.curvature, std::abs(after.max_curvature_jump - before.max_curvature_jump));
  }
  return measures;
}

}  // namespace isochor
