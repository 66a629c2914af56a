#include "isochor/bspline/model_refinement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/refinement.h"

namespace isochor {
namespace {

// Knots to insert, for both directions of every patch: [2 * patch + (0: u, 1: v)], ascending.
using Insertions = std::vector<std::vector<double>>;

size_t slot(int patch, Direction direction) {
  return 2 * static_cast<size_t>(patch) + (direction == Direction::kU ? 0 : 1);
}

// A knot of one side in the domain of the other; on a knot that is there already if it is one.
double mapped(double t, const KnotVector& from, const KnotVector& to, bool opposed,
              const std::vector<double>& already) {
  const double from_length = from.end() - from.begin();
  const double to_length = to.end() - to.begin();
  const double stretch = from_length == to_length ? 1.0 : to_length / from_length;
  double value =
      opposed ? to.begin() + (from.end() - t) * stretch : to.begin() + (t - from.begin()) * stretch;
  if (!opposed && stretch == 1.0 && from.begin() == to.begin()) value = t;
  for (const std::vector<double>& known : {to.breaks(), already}) {
    for (double there : known) {
      if (std::abs(there - value) <= kSameSide * to_length) return there;
    }
  }
  return value;
}

// Adds `incoming` so that each value occurs as often as in the list that has it more often.
bool merge_into(std::vector<double>* values, const std::vector<double>& incoming) {
  std::vector<double> missing;
  std::set_difference(incoming.begin(), incoming.end(), values->begin(), values->end(),
                      std::back_inserter(missing));
  values->insert(values->end(), missing.begin(), missing.end());
  std::sort(values->begin(), values->end());
  return !missing.empty();
}

void carry(const PatchModel& model, const SideRef& from, const SideRef& to, bool opposed,
           Insertions* insertions, bool* changed) {
  const auto& source = (*insertions)[slot(from.patch, running_direction(from.side))];
  auto& target = (*insertions)[slot(to.patch, running_direction(to.side))];
  if (source.empty()) return;
  const KnotVector& a =
      knots_of(model.patches[static_cast<size_t>(from.patch)], running_direction(from.side));
  const KnotVector& b =
      knots_of(model.patches[static_cast<size_t>(to.patch)], running_direction(to.side));
  std::vector<double> values;
  for (double t : source) values.push_back(mapped(t, a, b, opposed, target));
  std::sort(values.begin(), values.end());
  if (merge_into(&target, values)) *changed = true;
}

void spread(const PatchModel& model, const std::vector<Join>& joins, Insertions* insertions) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (const Join& join : joins) {
      if (!join.matching) continue;
      carry(model, join.a, join.b, join.opposed, insertions, &changed);
      carry(model, join.b, join.a, join.opposed, insertions, &changed);
    }
  }
}

// A pole as an affine combination of points (or of point classes): ids ascending.
struct Combination {
  std::vector<int> ids;
  std::vector<double> shares;
};

Combination collected(std::vector<std::pair<int, double>> terms) {
  std::sort(terms.begin(), terms.end());
  Combination out;
  for (const auto& [id, share] : terms) {
    if (!out.ids.empty() && out.ids.back() == id) {
      out.shares.back() += share;
    } else {
      out.ids.push_back(id);
      out.shares.push_back(share);
    }
  }
  // Shares that are only rounding may be missing in the neighbour's copy.
  Combination kept;
  for (size_t k = 0; k < out.ids.size(); ++k) {
    if (std::abs(out.shares[k]) <= kSameKnot) continue;
    kept.ids.push_back(out.ids[k]);
    kept.shares.push_back(out.shares[k]);
  }
  return kept;
}

// Finds points by the combination they stand for.
class PointsByCombination {
 public:
  // The point recorded for the same combination, or none. Combinations within one patch must agree
  // to rounding; those of two patches only as well as matching sides do.
  std::optional<int> find(const Combination& key, int patch) const {
    const auto found = table_.find(key.ids);
    if (found == table_.end()) return std::nullopt;
    for (const Entry& entry : found->second) {
      const double bound = entry.patch == patch ? 16 * kSameKnot : 16 * kSameSide;
      bool same = true;
      for (size_t k = 0; k < key.shares.size(); ++k) {
        if (std::abs(key.shares[k] - entry.shares[k]) > bound) same = false;
      }
      if (same) return entry.point;
    }
    return std::nullopt;
  }
  void add(const Combination& key, int patch, int point) {
    table_[key.ids].push_back({key.shares, patch, point});
  }

 private:
  struct Entry {
    std::vector<double> shares;
    int patch;
    int point;
  };
  std::map<std::vector<int>, std::vector<Entry>> table_;
};

class ModelRefiner {
 public:
  explicit ModelRefiner(const PatchModel& model)
      : old_(model), model_(model), classes_(point_classes(model)) {}

  void refine_patch(int q, const std::vector<double>& in_u, const std::vector<double>& in_v) {
    const Patch& before = old_.patches[static_cast<size_t>(q)];
    const auto [u_knots, u_map] = direction_map(before, Direction::kU, in_u);
    const auto [v_knots, v_map] = direction_map(before, Direction::kV, in_v);
    const Surface fine = isochor::refine(old_.surface(q), u_knots, u_map, v_knots, v_map);
    Patch after = before;
    after.u_knots = u_knots;
    after.v_knots = v_knots;
    after.weights = fine.weights();
    after.points.clear();
    for (int i = 0; i < fine.u_size(); ++i) {
      for (int j = 0; j < fine.v_size(); ++j) {
        after.points.push_back(
            point_for(q, terms(before, u_map.row(i), v_map.row(j)), fine.pole(i, j)));
      }
    }
    model_.patches[static_cast<size_t>(q)] = std::move(after);
  }

  PatchModel take() { return std::move(model_); }

 private:
  std::pair<KnotVector, BandedMap> direction_map(const Patch& patch, Direction direction,
                                                 const std::vector<double>& inserted) const {
    const KnotVector& knots = knots_of(patch, direction);
    if (inserted.empty()) return {knots, BandedMap::identity(knots.size())};
    try {
      if (wrapped_rows(patch, direction, classes_) > 0) {
        KnotVector fine = wrapped_with_knots(knots, inserted);
        return {fine, wrapped_insertion_map(knots, fine)};
      }
      KnotVector fine = with_knots(knots, inserted);
      return {fine, insertion_map(knots, fine)};
    } catch (const InputError& error) {
      throw InputError("", "refine " + label_of(patch), error.reason());
    }
  }

  // The pole of two rows as a combination of the patch's points.
  static std::vector<std::pair<int, double>> terms(const Patch& patch, const BandedMap::Row& u,
                                                   const BandedMap::Row& v) {
    std::vector<std::pair<int, double>> result;
    double weight = 0.0;
    for (int k = 0; k < u.count; ++k) {
      for (int l = 0; l < v.count; ++l) {
        const int i = u.first + k;
        const int j = v.first + l;
        double share = u.coefficients[k] * v.coefficients[l];
        if (!patch.weights.empty()) {
          share *= patch.weights[static_cast<size_t>(i) * patch.v_size() + j];
        }
        weight += share;
        result.emplace_back(patch.point(i, j), share);
      }
    }
    if (result.size() == 1) {
      result[0].second = 1.0;
    } else if (!patch.weights.empty()) {
      for (auto& term : result) term.second /= weight;
    }
    return result;
  }

  int point_for(int q, const std::vector<std::pair<int, double>>& of_points, const Vec3& value) {
    const Combination key = collected(of_points);
    if (key.ids.size() == 1) return key.ids[0];
    if (const auto known = by_points_.find(key, q)) return *known;
    const int point = static_cast<int>(model_.points.size());
    model_.points.push_back(value);
    by_points_.add(key, q, point);
    std::vector<std::pair<int, double>> of_classes;
    for (const auto& [id, share] : of_points) {
      of_classes.emplace_back(classes_.class_of[static_cast<size_t>(id)], share);
    }
    const Combination tied = collected(of_classes);
    if (tied.ids.size() == 1) {
      model_.ties.emplace_back(classes_.representative[static_cast<size_t>(tied.ids[0])], point);
    } else if (const auto other = by_classes_.find(tied, q)) {
      model_.ties.emplace_back(*other, point);
    } else {
      by_classes_.add(tied, q, point);
    }
    return point;
  }

  const PatchModel& old_;
  PatchModel model_;
  PointClasses classes_;
  PointsByCombination by_points_;
  PointsByCombination by_classes_;
};

// True when the poles of both boundary rows move together one to one.
bool rows_tied(const PatchModel& model, const Join& join, const PointClasses& classes) {
  const auto row = [&](const SideRef& ref) {
    const Patch& patch = model.patches[static_cast<size_t>(ref.patch)];
    std::vector<int> ids;
    for (const auto& [i, j] : side_indices(patch, ref.side)) {
      ids.push_back(classes.class_of[static_cast<size_t>(patch.point(i, j))]);
    }
    return ids;
  };
  const std::vector<int> a = row(join.a);
  std::vector<int> b = row(join.b);
  if (join.opposed) std::reverse(b.begin(), b.end());
  return a == b;
}

// Exact refinement moves nothing, so only the correspondence of the poles has to be looked at
// again.
void update_joins(const PatchModel& before, PatchModel* model, const Insertions& insertions) {
  const PointClasses classes_before = point_classes(before);
  const PointClasses classes = point_classes(*model);
  for (Join& join : model->joins) {
    if (join.common) continue;  // of whatever bases the two sides have
    bool touched = false;
    for (const SideRef& ref : {join.a, join.b}) {
      for (Direction direction : {Direction::kU, Direction::kV}) {
        touched = touched || !insertions[slot(ref.patch, direction)].empty();
      }
    }
    if (!touched) continue;
    const Join now = measure_join(*model, model->points, join);
    ISOCHOR_REQUIRE(now.matching || !join.matching, now.mismatch);
    ISOCHOR_REQUIRE(!join.matching || rows_tied(*model, join, classes) ||
                        !rows_tied(before, join, classes_before),
                    label_of(*model, join.a), label_of(*model, join.b));
    join.matching = now.matching;
    join.mismatch = now.mismatch;
  }
}

}  // namespace

PatchModel refine(const PatchModel& model, const std::vector<PatchKnots>& wanted) {
  const std::vector<Join> joins = model.joins.empty() ? find_joins(model) : model.joins;
  Insertions insertions(2 * model.patches.size());
  for (const PatchKnots& knots : wanted) {
    ISOCHOR_REQUIRE(0 <= knots.patch && knots.patch < static_cast<int>(model.patches.size()),
                    knots.patch, model.patches.size());
    const Patch& patch = model.patches[static_cast<size_t>(knots.patch)];
    merge_into(&insertions[slot(knots.patch, Direction::kU)],
               inserted_knots(patch.u_knots, knots.u));
    merge_into(&insertions[slot(knots.patch, Direction::kV)],
               inserted_knots(patch.v_knots, knots.v));
  }
  spread(model, joins, &insertions);
  ModelRefiner refiner(model);
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const auto& in_u = insertions[slot(q, Direction::kU)];
    const auto& in_v = insertions[slot(q, Direction::kV)];
    if (!in_u.empty() || !in_v.empty()) refiner.refine_patch(q, in_u, in_v);
  }
  PatchModel result = refiner.take();
  result.locks.clear();
  result.lock_reasons.clear();
  update_joins(model, &result, insertions);
  return result;
}

PatchModel refine(const PatchModel& model, int patch, const KnotVector& u, const KnotVector& v) {
  return refine(model, std::vector<PatchKnots>{{patch, u, v}});
}

PatchModel without_unused_points(const PatchModel& model) {
  std::vector<int> renumbered(model.points.size(), -1);
  for (const Patch& patch : model.patches) {
    for (int id : patch.points) renumbered[static_cast<size_t>(id)] = 0;
  }
  // A point nobody uses may still connect two ties: keep the classes, not the pairs.
  const PointClasses classes = point_classes(model);
  PatchModel result = model;
  result.points.clear();
  result.ties.clear();
  result.locks.clear();
  result.fixed_points.clear();
  std::vector<int> first_of_class(classes.representative.size(), -1);
  for (size_t i = 0; i < renumbered.size(); ++i) {
    if (renumbered[i] < 0) continue;
    renumbered[i] = static_cast<int>(result.points.size());
    result.points.push_back(model.points[i]);
    int& first = first_of_class[static_cast<size_t>(classes.class_of[i])];
    if (first < 0) {
      first = renumbered[i];
    } else {
      result.ties.emplace_back(first, renumbered[i]);
    }
  }
  for (const auto& [point, reason] : model.fixed_points) {
    const int id = renumbered[static_cast<size_t>(point)];
    if (id >= 0) result.fixed_points.emplace_back(id, reason);
  }
  for (Patch& patch : result.patches) {
    for (int& id : patch.points) id = renumbered[static_cast<size_t>(id)];
  }
  for (const Lock& lock : model.locks) {
    const int point = renumbered[static_cast<size_t>(lock.point)];
    if (point >= 0) result.locks.push_back({point, lock.reason});
  }
  return result;
}

}  // namespace isochor
