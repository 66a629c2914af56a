// What keeps the skin of a DisplacementSpace smooth: relations as equations, locks where none fit.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
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

// Gaussian elimination of sparse rows in doubles, by the largest entry of each row.
class RowElimination {
 public:
  // False when the row follows from those before it, up to kImpliedRow of its largest entry.
  // `locked`: the axes of each coefficient that stay zero.
  explicit RowElimination(const std::vector<unsigned>& locked) : locked_(locked) {}
  bool add(const CoefficientRow& row) {
    bool independent = false;
    for (int axis = 0; axis < 3; ++axis) independent = add(row, axis) || independent;
    return independent;
  }

 private:
  using Sparse = std::map<int, double>;

  bool add(const CoefficientRow& row, int axis) {
    Sparse rest;
    double size = 0.0;
    for (size_t k = 0; k < row.coefficient.size(); ++k) {
      if (locked_[static_cast<size_t>(row.coefficient[k])] >> axis & 1u) continue;
      const double value = row.value[k][axis];
      if (value != 0.0) rest[3 * row.coefficient[k] + axis] = value;
      size = std::max(size, std::abs(value));
    }
    if (size == 0.0) return false;
    // Later pivots do not contain the columns of earlier ones.
    std::set<size_t> waiting;
    const auto wait_for = [&](int column) {
      const auto known = pivot_of_.find(column);
      if (known != pivot_of_.end()) waiting.insert(known->second);
    };
    for (const auto& [column, value] : rest) wait_for(column);
    while (!waiting.empty()) {
      const size_t p = *waiting.begin();
      waiting.erase(waiting.begin());
      const auto& [pivot_column, pivot] = pivots_[p];
      const double factor = rest[pivot_column];
      if (factor == 0.0) continue;
      for (const auto& [column, value] : pivot) {
        if (rest.count(column) == 0) wait_for(column);
        rest[column] -= factor * value;
      }
      rest.erase(pivot_column);
    }
    int best = -1;
    double largest = kImpliedRow * size;
    for (const auto& [column, value] : rest) {
      if (std::abs(value) <= largest) continue;
      largest = std::abs(value);
      best = column;
    }
    if (best < 0) return false;
    const double scale = rest[best];
    for (auto& [column, value] : rest) value /= scale;
    pivot_of_[best] = pivots_.size();
    pivots_.emplace_back(best, std::move(rest));
    return true;
  }

  const std::vector<unsigned>& locked_;
  std::vector<std::pair<int, Sparse>> pivots_;
  std::map<int, size_t> pivot_of_;
};

}  // namespace

void DisplacementSpace::choose_relations(const PatchModel& model, const Options& options) {
  for (const SmoothRelation& relation : model.relations) {
    if (relation.kind == SmoothRelation::Kind::kTie) {
      relations_.push_back(relation);
      continue;
    }
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
  link_tied_curves();
  drop_rows_implied_by_ties();
}

// Coefficients of one equation of a tie are next to each other: extents grow across the edge.
void DisplacementSpace::link_tied_curves() {
  for (const KeptRow& kept : kept_rows_) {
    if (relations_[static_cast<size_t>(kept.relation)].kind != SmoothRelation::Kind::kTie) continue;
    for (int a : kept.row.coefficient) {
      for (int b : kept.row.coefficient) {
        std::vector<int>& known = neighbours_[static_cast<size_t>(a)];
        const auto at = std::lower_bound(known.begin(), known.end(), b);
        if (a != b && (at == known.end() || *at != b)) known.insert(at, b);
      }
    }
  }
}

// Where smooth lines end on an edge in different bases, the ties imply some of their equations up
// to the noise of measured factors. Taken as equations of their own they would forbid whatever the
// noise multiplies.
void DisplacementSpace::drop_rows_implied_by_ties() {
  std::set<int> tied, common_joins;
  for (const SmoothRelation& relation : relations_) {
    if (relation.kind == SmoothRelation::Kind::kTie) common_joins.insert(relation.join);
  }
  const auto is_common = [&](const KeptRow& kept) {
    return common_joins.count(relations_[static_cast<size_t>(kept.relation)].join) > 0;
  };
  for (const KeptRow& kept : kept_rows_) {
    if (!is_common(kept)) continue;
    tied.insert(kept.row.coefficient.begin(), kept.row.coefficient.end());
  }
  if (tied.empty()) return;
  std::vector<size_t> order;
  for (const bool ties : {true, false}) {
    for (size_t k = 0; k < kept_rows_.size(); ++k) {
      const std::vector<int>& own = kept_rows_[k].row.coefficient;
      const bool inside =
          std::all_of(own.begin(), own.end(), [&](int c) { return tied.count(c) > 0; });
      if (inside && is_common(kept_rows_[k]) == ties) order.push_back(k);
    }
  }
  std::vector<char> implied(kept_rows_.size(), 0);
  RowElimination elimination(locked_axes_);
  for (size_t k : order) implied[k] = elimination.add(kept_rows_[k].row) ? 0 : 1;
  std::vector<KeptRow> kept;
  for (size_t k = 0; k < kept_rows_.size(); ++k) {
    if (!implied[k]) kept.push_back(std::move(kept_rows_[k]));
  }
  kept_rows_ = std::move(kept);
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
