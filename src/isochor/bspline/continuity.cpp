#include "isochor/bspline/continuity.h"

#include <algorithm>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "isochor/bspline/joins.h"
#include "isochor/bspline/measured_lines.h"
#include "isochor/bspline/smooth_relations.h"
#include "isochor/bspline/smoothness.h"
#include "isochor/bspline/trims.h"

namespace isochor {
namespace {

const Patch& patch_of(const PatchModel& model, const SideRef& ref) {
  return model.patches[static_cast<size_t>(ref.patch)];
}

// "smoothly (G1)", for sentences about two surfaces.
std::string smoothly(Smoothness smoothness) {
  return smoothness == Smoothness::kAlmost ? "almost smoothly"
                                           : std::string("smoothly (") + name_of(smoothness) + ")";
}

// Whether function k along a side is somewhere nonzero on a part of it.
bool shapes_part(const Patch& patch, const SideRef& ref, const SidePart& part, int k) {
  if (part.whole()) return true;
  const KnotVector& knots = knots_of(patch, running_direction(ref.side));
  return knots[k] < part.to && knots[k + knots.degree() + 1] > part.from;
}

// Collects locks, each point and reason once.
class LockCollector {
 public:
  explicit LockCollector(PatchModel* model) : model_(model) {
    model_->locks.clear();
    model_->lock_reasons.clear();
  }

  int reason(const std::string& text, bool continuity, int join = -1) {
    auto& reasons = model_->lock_reasons;
    for (size_t i = 0; i < reasons.size(); ++i) {
      const LockReason& known = reasons[i];
      if (known.text == text && known.continuity == continuity && known.join == join) {
        return static_cast<int>(i);
      }
    }
    reasons.push_back({text, continuity, join});
    return static_cast<int>(reasons.size()) - 1;
  }

  void lock(int point, int reason) {
    if (seen_.insert({point, reason}).second) model_->locks.push_back({point, reason});
  }

  // Rows `from` .. `to` - 1 of a side, counted inwards; along it the poles that shape the part.
  void lock_rows(const SideRef& ref, const SidePart& part, int from, int to,
                 const std::string& text, bool continuity, int join = -1) {
    const Patch& patch = patch_of(*model_, ref);
    to = std::min(to, knots_of(patch, across_direction(ref.side)).size());
    if (from >= to) return;
    const int id = reason(text, continuity, join);
    for (int row = from; row < to; ++row) {
      for (const auto& [i, j] : side_indices(patch, ref.side, row)) {
        if (shapes_part(patch, ref, part, is_u_side(ref.side) ? j : i)) {
          lock(patch.point(i, j), id);
        }
      }
    }
  }

  // All poles of the functions `indices` of one direction.
  void lock_functions(int q, Direction direction, const std::vector<int>& indices,
                      const std::string& text, int join = -1) {
    if (indices.empty()) return;
    const Patch& patch = model_->patches[static_cast<size_t>(q)];
    const int id = reason(text, true, join);
    for (int k : indices) {
      if (direction == Direction::kU) {
        for (int j = 0; j < patch.v_size(); ++j) lock(patch.point(k, j), id);
      } else {
        for (int i = 0; i < patch.u_size(); ++i) lock(patch.point(i, k), id);
      }
    }
  }

 private:
  PatchModel* model_;
  std::set<std::pair<int, int>> seen_;
};

// What relations take care of, so that no lock has to.
class Covered {
 public:
  explicit Covered(const std::vector<SmoothRelation>& relations) {
    for (const SmoothRelation& relation : relations) {
      if (relation.kind == SmoothRelation::Kind::kKnotLine) {
        lines_.insert({relation.patch, relation.across, relation.knot});
      } else if (relation.kind == SmoothRelation::Kind::kPole) {
        for (const SideRef& ref : relation.sides) poles_.insert({ref.patch, ref.side});
      } else if (relation.kind != SmoothRelation::Kind::kTie) {
        joins_.insert(relation.join);
      }
    }
  }
  bool join(int k) const { return joins_.count(k) > 0; }
  bool line(int q, Direction across, double knot) const {
    return lines_.count({q, across, knot}) > 0;
  }
  bool pole(const SideRef& ref) const { return poles_.count({ref.patch, ref.side}) > 0; }

 private:
  std::set<int> joins_;
  std::set<std::tuple<int, Direction, double>> lines_;
  std::set<std::pair<int, Side>> poles_;
};

void lock_trim(const PatchModel& model, int q, LockCollector* locks) {
  const Patch& patch = model.patches[static_cast<size_t>(q)];
  if (patch.trim.empty()) return;
  const std::vector<TrimState> states =
      trim_states(patch, classify_elements(patch, released_boxes(model, q)));
  for (size_t k = 0; k < states.size(); ++k) {
    if (states[k] == TrimState::kFree) continue;
    const bool off = states[k] == TrimState::kTrimmedOff;
    locks->lock(patch.points[k],
                locks->reason(
                    label_of(patch) + (off ? " is trimmed: this pole shapes only what was cut away"
                                           : " is trimmed: this pole would move a trimming edge"),
                    false));
  }
}

int rows_for(const PatchModel& model, const SideRef& ref, int order) {
  return boundary_rows(knots_of(patch_of(model, ref), across_direction(ref.side)),
                       is_begin_side(ref.side), order);
}

void lock_side(const PatchModel& model, const LockedSide& locked, LockCollector* locks) {
  const std::string name = label_of(patch_of(model, locked.side));
  const int row = rows_for(model, locked.side, 0);
  locks->lock_rows(locked.side, locked.part, 0, row, name + " " + locked.reason, false);
  const int order = order_of(locked.smoothness);
  if (order == 0) return;
  locks->lock_rows(locked.side, locked.part, row, rows_for(model, locked.side, order),
                   name + " " + locked.reason + "; they meet " + smoothly(locked.smoothness) +
                       ", so the pole rows next to that edge stay too",
                   true);
}

void lock_wrap(const PatchModel& model, int k, LockCollector* locks) {
  const Join& join = model.joins[static_cast<size_t>(k)];
  const Patch& patch = patch_of(model, join.a);
  const Direction direction = across_direction(join.a.side);
  const KnotVector& knots = knots_of(patch, direction);
  const int order = protected_order(join.smoothness, knots.degree());
  const std::string text = label_of(patch) + " closes on itself " + smoothly(join.smoothness) +
                           " at its seam, where its knots would allow a crease";
  for (double end : {knots.begin(), knots.end()}) {
    if (order > knots.degree() - knots.multiplicity(knots.begin())) {
      locks->lock_functions(join.a.patch, direction, functions_rough_at(knots, end, order), text,
                            k);
    }
  }
}

void lock_join(const PatchModel& model, int k, bool covered, LockCollector* locks) {
  const Join& join = model.joins[static_cast<size_t>(k)];
  const std::string a = label_of(patch_of(model, join.a));
  const std::string b = label_of(patch_of(model, join.b));
  const bool seam = join.a.patch == join.b.patch;
  const int order = covered ? 0 : order_of(join.smoothness);
  const bool together = join.matching || join.common;
  for (const auto& [ref, part] : {std::pair(join.a, join.part_a), {join.b, join.part_b}}) {
    const int row = rows_for(model, ref, 0);
    if (!together) {
      locks->lock_rows(ref, part, 0, row,
                       (seam ? a + " meets itself at a seam" : a + " and " + b + " share an edge") +
                           " whose poles do not correspond (" + join.mismatch + ")",
                       false);
    }
    if (order > 0) {
      locks->lock_rows(ref, part, together ? 0 : row, rows_for(model, ref, order),
                       (seam ? a + " meets itself " : a + " and " + b + " meet ") +
                           smoothly(join.smoothness) + (seam ? " at its seam" : "") +
                           ": the poles next to that edge stay so that no crease appears",
                       true, k);
    }
  }
}

void lock_knot_lines(const PatchModel& model, int q, const internal::MeasuredLines& lines,
                     const Covered& covered, LockCollector* locks) {
  const Patch& patch = model.patches[static_cast<size_t>(q)];
  for (Direction direction : {Direction::kU, Direction::kV}) {
    const KnotVector& knots = knots_of(patch, direction);
    for (const KnotLine& line : internal::lines_of(lines, q, direction)) {
      if (line.measured <= line.guaranteed || covered.line(q, direction, line.knot)) continue;
      const int order = protected_order(line.measured, knots.degree());
      if (order <= knots.degree() - line.multiplicity) continue;
      locks->lock_functions(q, direction, functions_rough_at(knots, line.knot, order),
                            label_of(patch) + " is smooth (" + name_of(line.measured) +
                                ") across inner knot lines of " +
                                (direction == Direction::kU ? "u" : "v") +
                                " that would allow a crease: poles next to them stay (refine to "
                                "get freedom between)");
    }
  }
}

void lock_poles(const PatchModel& model, int q, const Surface& surface, double size,
                const PointClasses& classes, const Covered& covered, LockCollector* locks) {
  const Patch& patch = model.patches[static_cast<size_t>(q)];
  for (Side side : kSides) {
    const PoleSide pole = pole_side(surface, side, size);
    if (!pole.collapsed) continue;
    const std::string where =
        std::string("side ") + name_of(side) + " of " + label_of(patch) + " is one point";
    if (!is_collapsed(patch, side, classes)) {
      locks->lock_rows({q, side}, {}, 0, 1, where + ", but its poles are not tied to each other",
                       false);
    }
    if (pole.smoothness != Smoothness::kSharp && !covered.pole({q, side})) {
      locks->lock_rows({q, side}, {}, 0, 2,
                       where +
                           " with a tangent plane: the poles around it stay so that no tip "
                           "appears",
                       true);
    }
  }
}

}  // namespace

int order_of(Smoothness smoothness) {
  return smoothness == Smoothness::kSharp ? 0 : smoothness == Smoothness::kCurvature ? 2 : 1;
}

int protected_order(Smoothness measured, int degree) {
  return std::min(order_of(measured), std::max(1, degree - 1));
}

int boundary_rows(const KnotVector& across, bool begin_side, int order) {
  // Near the end, function k vanishes to order k - 1 once it starts at the end itself; the first
  // degree - multiplicity + 1 functions start before it and do not vanish. Unclamped knots that
  // repeat the end beyond the domain's own copy have functions before those, which vanish on the
  // whole domain.
  const int d = across.degree();
  const double end = begin_side ? across.begin() : across.end();
  const int idle =
      begin_side ? across.spans().front() - d : across.size() - 1 - across.spans().back();
  const int start_before = d - std::min(across.multiplicity(end), d);
  return idle + std::max(start_before, order) + 1;
}

std::vector<int> functions_rough_at(const KnotVector& knots, double knot, int order) {
  const int d = knots.degree();
  std::vector<int> rough;
  for (int j = 0; j < knots.size(); ++j) {
    const auto first = knots.knots().begin() + j;
    const auto copies = std::count(first, first + d + 2, knot);
    if (copies > d - order) rough.push_back(j);
  }
  return rough;
}

namespace {

void lock_all(PatchModel& model, std::vector<SmoothRelation> relations,
              const internal::MeasuredLines& lines) {
  LockCollector locks(&model);
  model.relations = std::move(relations);
  const Covered covered(model.relations);
  const double size = diagonal(model);
  const PointClasses classes = point_classes(model);
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    lock_trim(model, q, &locks);
    const Surface surface = model.surface(q);
    lock_knot_lines(model, q, lines, covered, &locks);
    lock_poles(model, q, surface, size, classes, covered, &locks);
  }
  for (size_t k = 0; k < model.locked_sides.size(); ++k) {
    if (side_is_released(model, static_cast<int>(k))) continue;
    lock_side(model, model.locked_sides[k], &locks);
  }
  for (size_t k = 0; k < model.fixed_points.size(); ++k) {
    if (corner_is_released(model, static_cast<int>(k))) continue;
    const auto& [point, reason] = model.fixed_points[k];
    locks.lock(point, locks.reason(reason, false));
  }
  for (int k = 0; k < static_cast<int>(model.joins.size()); ++k) {
    const Join& join = model.joins[static_cast<size_t>(k)];
    if (!is_wrap(model, join, classes)) {
      lock_join(model, k, covered.join(k), &locks);
    } else if (!covered.join(k)) {
      lock_wrap(model, k, &locks);
    }
  }
}

}  // namespace

void derive_locks(PatchModel& model) {
  const internal::MeasuredLines lines = internal::measured_lines(model);
  lock_all(model, internal::smooth_relations(model, lines), lines);
}

void derive_locks(PatchModel& model, std::vector<SmoothRelation> relations) {
  lock_all(model, std::move(relations), internal::measured_lines(model));
}

}  // namespace isochor
