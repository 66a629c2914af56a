// What keeps the skin of a DisplacementSpace smooth: relations as equations, locks where none fit.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "isochor/base/tolerance.h"
#include "isochor/edit/displacement_space.h"

namespace isochor {
namespace {

// What the options keep at a join; at knot lines and poles (join -1) the default.
Continuity kept_at(const PatchModel& model, const DisplacementSpace::Options& options, int join) {
  if (join >= 0) {
    const Join& at = model.joins[static_cast<size_t>(join)];
    for (const DisplacementSpace::EdgeRule& rule : options.edges) {
      const bool same = (at.a.patch == rule.a && at.b.patch == rule.b) ||
                        (at.a.patch == rule.b && at.b.patch == rule.a);
      if (same) return rule.keep;
    }
  }
  return options.continuity;
}

// Two rows say the same: on each axis one is a multiple of the other, up to rounding.
bool same_equations(const CoefficientRow& a, const CoefficientRow& b) {
  for (int axis = 0; axis < 3; ++axis) {
    size_t largest = 0;
    for (size_t k = 1; k < a.value.size(); ++k) {
      if (std::abs(a.value[k][axis]) > std::abs(a.value[largest][axis])) largest = k;
    }
    const double a_size = a.value[largest][axis];
    const double b_size = b.value[largest][axis];
    if (a_size == 0.0 || b_size == 0.0) {
      if (a_size != b_size) return false;
      continue;
    }
    for (size_t k = 0; k < a.value.size(); ++k) {
      const double difference = a.value[k][axis] / a_size - b.value[k][axis] / b_size;
      if (!(std::abs(difference) <= kSameRow)) return false;
    }
  }
  return true;
}

}  // namespace

void DisplacementSpace::choose_relations(const PatchModel& model, const Options& options) {
  for (const SmoothRelation& relation : model.relations) {
    const Continuity keep = kept_at(model, options, relation.join);
    if (keep == Continuity::kC0) continue;
    const bool without_curvature = keep == Continuity::kTangent && relation.order > 1;
    if (without_curvature && relation.equations.size() < 2) continue;  // the basis keeps tangents
    relations_.push_back(relation);
    if (!without_curvature) continue;
    relations_.back().order = 1;
    relations_.back().equations.resize(1);
  }
}

void DisplacementSpace::apply_locks(const PatchModel& model, const Options& options) {
  for (const Lock& lock : model.locks) {
    const LockReason& reason = model.lock_reasons[static_cast<size_t>(lock.reason)];
    if (reason.continuity && kept_at(model, options, reason.join) == Continuity::kC0) continue;
    lock_points({lock.point}, reason.text);
  }
}

// Equations in terms of grid entries; the relations that this scale cannot state are locks.
std::vector<ContinuityRow> DisplacementSpace::stated_relations(const PatchModel& model) {
  std::vector<CoarseKnots> coarse;
  for (const Grid& grid : grids_) coarse.push_back({grid.u.coarse, grid.v.coarse});
  ContinuityRows rows = continuity_rows(model, relations_, coarse);
  for (int r : rows.inexpressible) {
    const SmoothRelation& relation = relations_[static_cast<size_t>(r)];
    lock_points(points_locking(model, relation),
                relation.text + ", which the chosen scale cannot keep otherwise");
  }
  return std::move(rows.rows);
}

void DisplacementSpace::make_kept_rows(const std::vector<ContinuityRow>& rows, bool mirrored) {
  for (const ContinuityRow& row : rows) {
    CoefficientRow kept = combination(row.terms);
    if (!kept.coefficient.empty()) kept_rows_.push_back({std::move(kept), row.relation});
  }
  if (mirrored) drop_mirrored_rows();
}

// A relation and its mirror image are one relation on mirrored coefficients. Where the images agree
// only up to rounding, two nearly equal rows would take freedom that is not theirs.
void DisplacementSpace::drop_mirrored_rows() {
  std::map<std::vector<int>, std::vector<size_t>> by_support;
  std::vector<KeptRow> kept;
  for (KeptRow& row : kept_rows_) {
    std::vector<size_t>& others = by_support[row.row.coefficient];
    const bool known = std::any_of(others.begin(), others.end(),
                                   [&](size_t k) { return same_equations(kept[k].row, row.row); });
    if (known) continue;
    others.push_back(kept.size());
    kept.push_back(std::move(row));
  }
  kept_rows_ = std::move(kept);
}

}  // namespace isochor
