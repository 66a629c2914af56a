#include "isochor/edit/follow.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "isochor/base/error.h"
#include "isochor/bspline/basis.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/model_refinement.h"
#include "isochor/bspline/refinement.h"
#include "isochor/edit/displacement_space.h"
#include "isochor/edit/names.h"

namespace isochor {
namespace {

// The part of the tolerance that the fit may use at its places; the rest is for what lies between
// them and for the new curve of the edge.
constexpr double kShareOfFit = 0.25;
// Weights beside the mean diagonal of the normal equations: of the roughness, and of the slack of
// the kept rows, which iterations then remove.
constexpr double kRoughness = 1e-5;
constexpr double kSlack = 1e-9;
// A pole that moves farther than the curve, by this factor, is a wave and not a following: the
// basis is too coarse.
constexpr double kOvershoot = 2.0;
constexpr int kCorrections = 4;
constexpr int kMostRounds = 9;
constexpr size_t kMostPoles = 20000;

using Matrix = Eigen::SparseMatrix<double>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

// A place along the shared curve, on the follower, and the displacement it needs.
struct Target {
  Uv uv;
  Vec3 by = Vec3::Zero();
};

// What the follower still lacks along the curves it shares with other patches.
std::vector<Target> targets(const PatchModel& rest, const std::vector<Vec3>& points, int follower,
                            const std::set<int>& followers) {
  const auto displacement = [&](int q, const std::vector<Uv>& places) {
    const Surface before = rest.surface(q), after = rest.surface(q, points);
    std::vector<Vec3> result;
    for (const Uv& uv : places)
      result.push_back(after.point(uv.u, uv.v) - before.point(uv.u, uv.v));
    return result;
  };
  std::vector<Target> result;
  for (const SharedTrim& trim : rest.shared_trims) {
    for (size_t own = 0; own < 2; ++own) {
      const int leader = trim.patches[1 - own];
      const bool follows = trim.released[own] && trim.patches[own] == follower;
      if (!follows || followers.count(leader) > 0) continue;
      const auto needed = displacement(leader, trim.along[1 - own]);
      const auto has = displacement(follower, trim.along[own]);
      for (size_t k = 0; k < needed.size(); ++k) {
        result.push_back({trim.along[own][k], needed[k] - has[k]});
      }
    }
  }
  return result;
}

// The least squares problem of one follower in one basis.
class Fit {
 public:
  Fit(const PatchModel& rest, int follower, Continuity continuity)
      : rest_(rest), follower_(follower), space_(rest, options_for(continuity)) {
    number_unknowns();
  }

  // The displacement of all points of the rest shape, and the deviation left at each target.
  std::vector<Vec3> solve(const std::vector<Target>& targets, std::vector<double>& deviations);

 private:
  static DisplacementSpace::Options options_for(Continuity continuity) {
    DisplacementSpace::Options options;
    options.continuity = continuity;
    return options;
  }
  // Calls add(unknown, value) for the terms of a row that are free. Without symmetry the values of
  // the three axes are the same.
  template <typename Add>
  void terms(const CoefficientRow& row, const Add& add) const {
    for (size_t k = 0; k < row.coefficient.size(); ++k) {
      const int unknown = unknowns_[static_cast<size_t>(row.coefficient[k])];
      if (unknown >= 0) add(unknown, row.value[k].x());
    }
  }
  void number_unknowns();
  Matrix rows_of(const std::vector<Target>& targets) const;
  Matrix roughness() const;
  Matrix kept() const;
  Columns minimise(const Matrix& rows, const Columns& right) const;

  const PatchModel& rest_;
  int follower_;
  DisplacementSpace space_;
  std::vector<int> unknowns_;  // by coefficient; -1: fixed
  int count_ = 0;
};

// Coefficients of the follower that nothing locks and no other patch shares.
void Fit::number_unknowns() {
  const auto grid = [&](int q, const auto& visit) {
    for (int i = 0; i < space_.u_knots(q).size(); ++i) {
      for (int j = 0; j < space_.v_knots(q).size(); ++j) {
        visit(static_cast<size_t>(space_.coefficient(q, i, j)));
      }
    }
  };
  std::vector<char> own(static_cast<size_t>(space_.size()), 0);
  grid(follower_, [&](size_t c) { own[c] = 1; });
  for (int q = 0; q < static_cast<int>(rest_.patches.size()); ++q) {
    if (q != follower_) grid(q, [&](size_t c) { own[c] = 0; });
  }
  unknowns_.assign(own.size(), -1);
  for (size_t c = 0; c < own.size(); ++c) {
    if (own[c] != 0 && space_.locked_axes(static_cast<int>(c)) == 0) unknowns_[c] = count_++;
  }
}

Matrix Fit::rows_of(const std::vector<Target>& targets) const {
  std::vector<Eigen::Triplet<double>> entries;
  const Patch& patch = rest_.patches[static_cast<size_t>(follower_)];
  for (size_t k = 0; k < targets.size(); ++k) {
    const BasisValues u = evaluate_basis(patch.u_knots, targets[k].uv.u);
    const BasisValues v = evaluate_basis(patch.v_knots, targets[k].uv.v);
    const auto weight = [&](int i, int j) {
      return patch.weights.empty()
                 ? 1.0
                 : patch.weights[static_cast<size_t>(u.first + i) * patch.v_size() + v.first + j];
    };
    double sum = 0.0;
    for (int i = 0; i <= u.degree; ++i) {
      for (int j = 0; j <= v.degree; ++j) sum += weight(i, j) * u.value(0, i) * v.value(0, j);
    }
    for (int i = 0; i <= u.degree; ++i) {
      for (int j = 0; j <= v.degree; ++j) {
        const int c = space_.coefficient(follower_, u.first + i, v.first + j);
        const int unknown = unknowns_[static_cast<size_t>(c)];
        const double value = weight(i, j) * u.value(0, i) * v.value(0, j) / sum;
        if (unknown >= 0) entries.emplace_back(static_cast<int>(k), unknown, value);
      }
    }
  }
  Matrix rows(static_cast<int>(targets.size()), count_);
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

// Each coefficient minus the mean of its neighbours on the control net; fixed ones are zero.
Matrix Fit::roughness() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (size_t c = 0; c < unknowns_.size(); ++c) {
    if (unknowns_[c] < 0) continue;
    const auto& around = space_.neighbours(static_cast<int>(c));
    entries.emplace_back(unknowns_[c], unknowns_[c], 1.0);
    for (int other : around) {
      const int unknown = unknowns_[static_cast<size_t>(other)];
      if (unknown >= 0) {
        entries.emplace_back(unknowns_[c], unknown, -1.0 / static_cast<double>(around.size()));
      }
    }
  }
  Matrix rows(count_, count_);
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

Matrix Fit::kept() const {
  std::vector<Eigen::Triplet<double>> entries;
  int row = 0;
  for (const KeptRow& kept : space_.kept_rows()) {
    double largest = 0.0;
    terms(kept.row, [&](int, double value) { largest = std::max(largest, std::abs(value)); });
    if (largest == 0.0) continue;
    terms(kept.row,
          [&](int unknown, double value) { entries.emplace_back(row, unknown, value / largest); });
    ++row;
  }
  Matrix rows(row, count_);
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

// min |A x - b|^2 + roughness, subject to K x = 0: the optimality system with a slack on K x, which
// makes it quasi-definite (K may have dependent rows); repeated solutions for the remainder take
// the slack back.
Columns Fit::minimise(const Matrix& rows, const Columns& right) const {
  const Matrix rough = roughness(), constraints = kept();
  Matrix normal = rows.transpose() * rows;
  const double mean = std::max(normal.diagonal().sum() / std::max(1, count_), 1e-300);
  normal += kRoughness * mean * Matrix(rough.transpose() * rough);
  const int held = static_cast<int>(constraints.rows());
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](const Matrix& block, int first_row) {
    for (int k = 0; k < block.outerSize(); ++k) {
      for (Matrix::InnerIterator it(block, k); it; ++it) {
        entries.emplace_back(first_row + static_cast<int>(it.row()), static_cast<int>(it.col()),
                             it.value());
        if (first_row == 0) continue;
        entries.emplace_back(static_cast<int>(it.col()), first_row + static_cast<int>(it.row()),
                             it.value());
      }
    }
  };
  add(normal, 0);
  if (held > 0) add(mean * constraints, count_);
  Matrix exact(count_ + held, count_ + held);
  exact.setFromTriplets(entries.begin(), entries.end());
  for (int k = 0; k < held; ++k) entries.emplace_back(count_ + k, count_ + k, -kSlack * mean);
  Matrix slackened(count_ + held, count_ + held);
  slackened.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Matrix> factors(slackened);
  Columns wanted = Columns::Zero(count_ + held, 3);
  wanted.topRows(count_) = rows.transpose() * right;
  Columns solution = factors.solve(wanted);
  for (int k = 0; k < kCorrections; ++k) solution += factors.solve(wanted - exact * solution);
  return solution.topRows(count_);
}

std::vector<Vec3> Fit::solve(const std::vector<Target>& targets, std::vector<double>& deviations) {
  Columns right(static_cast<int>(targets.size()), 3);
  for (size_t k = 0; k < targets.size(); ++k) right.row(static_cast<int>(k)) = targets[k].by;
  const Matrix rows = rows_of(targets);
  const Columns solution = count_ > 0 ? minimise(rows, right) : Columns(0, 3);
  std::vector<Vec3> delta(unknowns_.size(), Vec3::Zero());
  for (size_t c = 0; c < unknowns_.size(); ++c) {
    if (unknowns_[c] >= 0) delta[c] = solution.row(unknowns_[c]);
  }
  const Columns left = right - rows * solution;
  deviations.clear();
  for (int k = 0; k < left.rows(); ++k) deviations.push_back(left.row(k).norm());
  return space_.expand(delta);
}

// Halves the spans at places that deviate.
KnotVector halved(const KnotVector& knots, const std::vector<double>& at) {
  const std::vector<double> breaks = knots.breaks();
  std::set<double> inserted;
  for (double value : at) {
    const auto next = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, value);
    inserted.insert(0.5 * (*(next - 1) + *next));
  }
  const std::vector<double> list(inserted.begin(), inserted.end());
  return wrapped_poles(knots) > 0 ? wrapped_with_knots(knots, list) : with_knots(knots, list);
}

// Both states of the model with those spans halved.
void refine_where_needed(int follower, const std::vector<Target>& targets,
                         const std::vector<double>& deviations, double limit, Followed& state) {
  std::vector<double> u, v;
  for (size_t k = 0; k < targets.size(); ++k) {
    if (deviations[k] <= limit) continue;
    u.push_back(targets[k].uv.u);
    v.push_back(targets[k].uv.v);
  }
  const Patch& patch = state.rest.patches[static_cast<size_t>(follower)];
  const KnotVector finer_u = halved(patch.u_knots, u), finer_v = halved(patch.v_knots, v);
  PatchModel moved = state.rest;
  moved.points = state.points;
  state.points = refine(moved, follower, finer_u, finer_v).points;
  state.rest = refine(state.rest, follower, finer_u, finer_v);
  derive_locks(state.rest);
}

// One follower, refined until it follows closely enough.
void follow_one(int follower, const std::set<int>& followers, const Follow& follow,
                Continuity continuity, Followed& state) {
  const auto patch = [&]() -> const Patch& {
    return state.rest.patches[static_cast<size_t>(follower)];
  };
  FollowRecord record;
  record.patch = label_of(patch());
  record.poles_before = static_cast<int>(patch().points.size());
  const double limit = kShareOfFit * follow.tolerance;
  if (targets(state.rest, state.points, follower, followers).empty()) return;  // nothing moved
  for (int round = 0;; ++round) {
    const auto wanted = targets(state.rest, state.points, follower, followers);
    std::vector<double> deviations;
    const auto displacement = Fit(state.rest, follower, continuity).solve(wanted, deviations);
    record.deviation = *std::max_element(deviations.begin(), deviations.end());
    record.poles_after = static_cast<int>(patch().points.size());
    record.max_distance = 0.0;
    for (const Vec3& d : displacement)
      record.max_distance = std::max(record.max_distance, d.norm());
    double asked = 0.0;
    for (const Target& target : wanted) asked = std::max(asked, target.by.norm());
    if (record.deviation <= limit && record.max_distance <= kOvershoot * asked) {
      for (size_t k = 0; k < displacement.size(); ++k) state.points[k] += displacement[k];
      state.records.push_back(record);
      return;
    }
    if (round == kMostRounds || patch().points.size() > kMostPoles) {
      const bool waves = record.deviation <= limit;
      state.refusal =
          record.patch + " cannot follow within " + number(follow.tolerance) + ": with " +
          std::to_string(record.poles_after) + " poles it still " +
          (waves ? "moves farther than the trimming curve, by up to " + number(record.max_distance)
                 : "misses the moved trimming curve by " + number(record.deviation)) +
          "; state a larger tolerance, move farther from its other edges, or move less";
      return;
    }
    const bool waves = record.deviation <= limit;
    refine_where_needed(follower, wanted, deviations, waves ? 0.0 : limit, state);
  }
}

// Frees the followers' side of the curves that have moved, and only of those.
void release_for_followers(const std::set<int>& followers, const std::vector<Vec3>& points,
                           PatchModel& rest) {
  for (SharedTrim& trim : rest.shared_trims) {
    for (size_t own = 0; own < 2; ++own) {
      const int leader = trim.patches[1 - own];
      if (!trim.released[1 - own] || followers.count(trim.patches[own]) == 0) continue;
      const Surface before = rest.surface(leader), after = rest.surface(leader, points);
      const auto& along = trim.along[1 - own];
      trim.released[own] = std::any_of(along.begin(), along.end(), [&](const Uv& uv) {
        return after.point(uv.u, uv.v) != before.point(uv.u, uv.v);
      });
    }
  }
  derive_locks(rest);
}

std::set<int> patches_of(const PatchModel& model, const Follow& follow) {
  std::set<int> patches;
  for (const std::string& name : follow.faces) patches.insert(find_patch(model, name));
  return patches;
}

}  // namespace

PatchModel with_released_trims(const PatchModel& model, const Follow& follow) {
  const std::set<int> followers = patches_of(model, follow);
  PatchModel released = model;
  for (int q : followers) {
    const std::string name = label_of(model.patches[static_cast<size_t>(q)]);
    bool found = false;
    for (SharedTrim& trim : released.shared_trims) {
      const bool first = trim.patches[0] == q;
      if (!first && trim.patches[1] != q) continue;
      const int other = trim.patches[first ? 1 : 0];
      if (followers.count(other) > 0) continue;
      if (trim.smoothness != Smoothness::kSharp) {
        throw InputError("", "follow",
                         name + " meets " + label_of(model.patches[static_cast<size_t>(other)]) +
                             " smoothly (" + name_of(trim.smoothness) +
                             ") at their trimming curve: a refit would leave a crease");
      }
      trim.released[first ? 1 : 0] = found = true;
    }
    if (!found) {
      throw InputError("", "follow", name + " shares no trimming curve with another editable face");
    }
  }
  derive_locks(released);
  return released;
}

PatchModel with_locked_trims(PatchModel model) {
  for (SharedTrim& trim : model.shared_trims) trim.released = {};
  derive_locks(model);
  return model;
}

Followed make_follow(const PatchModel& before, const std::vector<Vec3>& points,
                     const Follow& follow, Continuity continuity) {
  Followed state;
  state.rest = before;
  state.points = points;
  const std::set<int> followers = patches_of(before, follow);
  release_for_followers(followers, points, state.rest);
  for (int q : followers) {
    if (state.refusal.empty()) follow_one(q, followers, follow, continuity, state);
  }
  return state;
}

}  // namespace isochor
