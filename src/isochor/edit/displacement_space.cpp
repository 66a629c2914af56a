#include "isochor/edit/displacement_space.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/bspline/joins.h"
#include "isochor/edit/names.h"

namespace isochor {
namespace {

constexpr unsigned kAllAxes = 7;

std::vector<PatchScale> scales_of(const PatchModel& model, const Scale& scale) {
  switch (scale.kind) {
    case Scale::Kind::kFinest:
      return finest_scale(model);
    case Scale::Kind::kEvery:
      return keep_every(model, scale.every);
    case Scale::Kind::kKnots:
      break;
  }
  std::vector<KeptKnots> kept;
  for (const auto& [name, lists] : scale.knots) {
    kept.push_back({find_patch(model, name), lists[0], lists[1]});
  }
  return keep_knots(model, kept);
}

}  // namespace

// Disjoint sets of grid entries.
class DisplacementSpace::EntrySets {
 public:
  explicit EntrySets(int count) : parent_(static_cast<size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int root(int i) {
    while (parent_[static_cast<size_t>(i)] != i) {
      int& up = parent_[static_cast<size_t>(i)];
      up = parent_[static_cast<size_t>(up)];
      i = up;
    }
    return i;
  }
  void merge(int a, int b) {
    a = root(a);
    b = root(b);
    parent_[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

DisplacementSpace::DisplacementSpace(const PatchModel& model, const Options& options) {
  class_of_point_ = point_classes(model).class_of;
  make_grids(model, options.scale);
  tie_entries(model);
  make_rows(model);
  make_places(model);
  check_ties(model);
  choose_relations(model, options);
  apply_locks(model, options);
  const std::vector<ContinuityRow> rows = stated_relations(model);
  for (int axis : options.symmetry_axes) mirror(model, axis);
  make_kept_rows(rows, !options.symmetry_axes.empty());
}

int DisplacementSpace::entry_index(int q, int i, int j) const {
  const Grid& grid = grids_[static_cast<size_t>(q)];
  ISOCHOR_REQUIRE(0 <= i && i < grid.u.coarse.size() && 0 <= j && j < grid.v.coarse.size(), q, i,
                  j);
  return grid.offset + i * grid.v.coarse.size() + j;
}

int DisplacementSpace::coefficient(int q, int i, int j) const {
  return entries_[static_cast<size_t>(entry_index(q, i, j))].coefficient;
}

Vec3 DisplacementSpace::signs(int q, int i, int j) const {
  const unsigned flipped = entries_[static_cast<size_t>(entry_index(q, i, j))].flipped;
  return Vec3(flipped & 1u ? -1.0 : 1.0, flipped & 2u ? -1.0 : 1.0, flipped & 4u ? -1.0 : 1.0);
}

const std::string& DisplacementSpace::lock_reason(int c) const {
  static const std::string kNone;
  const int reason = lock_reason_of_[static_cast<size_t>(c)];
  return reason < 0 ? kNone : lock_reasons_[static_cast<size_t>(reason)];
}

void DisplacementSpace::make_grids(const PatchModel& model, const Scale& scale) {
  int offset = 0;
  for (PatchScale& patch : scales_of(model, scale)) {
    const int size = patch.u.coarse.size() * patch.v.coarse.size();
    grids_.push_back({std::move(patch.u), std::move(patch.v), offset});
    offset += size;
  }
  entries_.resize(static_cast<size_t>(offset));
}

// The seam of a periodic direction: row i is row i + n - k, for the k rows that wrap.
void DisplacementSpace::tie_wrap(const SideRef& ref, EntrySets& sets) {
  const Grid& grid = grids_[static_cast<size_t>(ref.patch)];
  const bool along_u = is_u_side(ref.side);
  const KnotVector& across = along_u ? grid.u.coarse : grid.v.coarse;
  const int others = along_u ? grid.v.coarse.size() : grid.u.coarse.size();
  const int wrapped = wrapped_poles(across);
  for (int i = 0; i < wrapped; ++i) {
    const int image = i + across.size() - wrapped;
    for (int j = 0; j < others; ++j) {
      sets.merge(along_u ? entry_index(ref.patch, i, j) : entry_index(ref.patch, j, i),
                 along_u ? entry_index(ref.patch, image, j) : entry_index(ref.patch, j, image));
    }
  }
}

// Ties coarse entries wherever the fine points they copy are tied: a fine grid row that is a unit
// row stands for its coarse coefficient. Boundary rows of joined sides are tied along the join.
void DisplacementSpace::tie_entries(const PatchModel& model) {
  EntrySets sets(static_cast<int>(entries_.size()));
  std::vector<int> entry_of_class;
  for (size_t q = 0; q < model.patches.size(); ++q) {
    const Patch& patch = model.patches[q];
    const Grid& grid = grids_[q];
    for (int i = 0; i < patch.u_size(); ++i) {
      const BandedMap::Row u = grid.u.map.row(i);
      if (!u.unit()) continue;
      for (int j = 0; j < patch.v_size(); ++j) {
        const BandedMap::Row v = grid.v.map.row(j);
        if (!v.unit()) continue;
        const auto c = static_cast<size_t>(class_of_point_[static_cast<size_t>(patch.point(i, j))]);
        if (entry_of_class.size() <= c) entry_of_class.resize(c + 1, -1);
        const int entry = entry_index(static_cast<int>(q), u.first, v.first);
        if (entry_of_class[c] < 0) {
          entry_of_class[c] = entry;
        } else {
          sets.merge(entry_of_class[c], entry);
        }
      }
    }
  }
  const auto coarse_side = [&](const SideRef& ref) {
    const Grid& grid = grids_[static_cast<size_t>(ref.patch)];
    const int nu = grid.u.coarse.size();
    const int nv = grid.v.coarse.size();
    std::vector<int> side;
    if (is_u_side(ref.side)) {
      const int i = ref.side == Side::kUBegin ? 0 : nu - 1;
      for (int j = 0; j < nv; ++j) side.push_back(entry_index(ref.patch, i, j));
    } else {
      const int j = ref.side == Side::kVBegin ? 0 : nv - 1;
      for (int i = 0; i < nu; ++i) side.push_back(entry_index(ref.patch, i, j));
    }
    return side;
  };
  const PointClasses point_classes_of_model = point_classes(model);
  for (const Join& join : model.joins) {
    if (!join.matching) continue;
    if (is_wrap(model, join, point_classes_of_model)) {
      tie_wrap(join.a, sets);
      continue;
    }
    const std::vector<int> a = coarse_side(join.a);
    std::vector<int> b = coarse_side(join.b);
    if (a.size() != b.size()) continue;  // check_ties locks what this leaves untied
    if (join.opposed) std::reverse(b.begin(), b.end());
    for (size_t k = 0; k < a.size(); ++k) sets.merge(a[k], b[k]);
  }
  // A collapsed side moves as one point at every scale.
  for (size_t q = 0; q < model.patches.size(); ++q) {
    for (Side side : kSides) {
      const Patch& patch = model.patches[q];
      std::set<int> classes;
      for (const auto& [i, j] : side_indices(patch, side)) {
        classes.insert(class_of_point_[static_cast<size_t>(patch.point(i, j))]);
      }
      if (classes.size() != 1) continue;
      const std::vector<int> row = coarse_side({static_cast<int>(q), side});
      for (int entry : row) sets.merge(row.front(), entry);
    }
  }
  std::vector<int> number(entries_.size(), -1);
  int count = 0;
  for (size_t e = 0; e < entries_.size(); ++e) {
    const auto root = static_cast<size_t>(sets.root(static_cast<int>(e)));
    if (number[root] < 0) number[root] = count++;
    entries_[e].coefficient = number[root];
  }
  places_.assign(static_cast<size_t>(count), Vec3::Zero());
}

std::vector<DisplacementSpace::RowTerm> DisplacementSpace::terms_of(int q, int i, int j) const {
  const Grid& grid = grids_[static_cast<size_t>(q)];
  const BandedMap::Row u = grid.u.map.row(i);
  const BandedMap::Row v = grid.v.map.row(j);
  std::vector<RowTerm> terms;
  terms.reserve(static_cast<size_t>(u.count) * static_cast<size_t>(v.count));
  for (int a = 0; a < u.count; ++a) {
    for (int b = 0; b < v.count; ++b) {
      const double value = u.coefficients[a] * v.coefficients[b];
      if (value != 0.0) terms.push_back({entry_index(q, u.first + a, v.first + b), value});
    }
  }
  return terms;
}

void DisplacementSpace::make_rows(const PatchModel& model) {
  size_t classes = 0;
  for (int c : class_of_point_) classes = std::max(classes, static_cast<size_t>(c) + 1);
  rows_.assign(classes, {});
  for (size_t q = 0; q < model.patches.size(); ++q) {
    const Patch& patch = model.patches[q];
    for (int i = 0; i < patch.u_size(); ++i) {
      for (int j = 0; j < patch.v_size(); ++j) {
        auto& row =
            rows_[static_cast<size_t>(class_of_point_[static_cast<size_t>(patch.point(i, j))])];
        if (row.empty()) row = terms_of(static_cast<int>(q), i, j);
      }
    }
  }
}

// Tied points take their displacement from one row. Where the other grids would give them another
// one (the scale differs on the two sides of a tie), the coefficients involved are locked instead.
void DisplacementSpace::check_ties(const PatchModel& model) {
  const auto compress = [&](const std::vector<RowTerm>& terms, double sign,
                            std::map<int, double>& into) {
    for (const RowTerm& term : terms) {
      into[entries_[static_cast<size_t>(term.entry)].coefficient] += sign * term.value;
    }
  };
  for (size_t q = 0; q < model.patches.size(); ++q) {
    const Patch& patch = model.patches[q];
    for (int i = 0; i < patch.u_size(); ++i) {
      for (int j = 0; j < patch.v_size(); ++j) {
        const auto& row =
            rows_[static_cast<size_t>(class_of_point_[static_cast<size_t>(patch.point(i, j))])];
        const std::vector<RowTerm> own = terms_of(static_cast<int>(q), i, j);
        std::map<int, double> difference;
        compress(row, 1.0, difference);
        compress(own, -1.0, difference);
        const bool same = std::all_of(difference.begin(), difference.end(), [](const auto& item) {
          return std::abs(item.second) <= kSameRow;
        });
        if (same) continue;
        for (const auto& item : difference) {
          lock_coefficient(
              item.first, kAllAxes,
              "the chosen scale keeps different knots on the two sides of a join here");
        }
      }
    }
  }
}

void DisplacementSpace::make_places(const PatchModel& model) {
  const size_t count = places_.size();
  weights_.assign(count, 1.0);
  patch_of_.assign(count, -1);
  locked_axes_.assign(count, 0);
  lock_reason_of_.assign(count, -1);
  std::vector<std::set<int>> neighbours(count);
  std::vector<char> inside(count, 0);
  // A wrapped row and its copy are one coefficient: the copy whose mean of knots lies inside the
  // domain is the one that says where it is.
  const auto mean_is_inside = [](const KnotVector& knots, int i) {
    double sum = 0.0;
    for (int k = 1; k <= knots.degree(); ++k) sum += knots[i + k];
    const double mean = sum / knots.degree();
    return knots.begin() <= mean && mean <= knots.end();
  };
  for (size_t q = 0; q < grids_.size(); ++q) {
    const Grid& grid = grids_[q];
    const Surface surface = model.surface(static_cast<int>(q));
    const int nu = grid.u.coarse.size();
    const int nv = grid.v.coarse.size();
    for (int i = 0; i < nu; ++i) {
      for (int j = 0; j < nv; ++j) {
        const int c = coefficient(static_cast<int>(q), i, j);
        const auto at = static_cast<size_t>(c);
        const bool better =
            !inside[at] && mean_is_inside(grid.u.coarse, i) && mean_is_inside(grid.v.coarse, j);
        if (patch_of_[at] < 0 || better) {
          inside[at] = better;
          patch_of_[at] = static_cast<int>(q);
          places_[at] = surface.point(grid.u.coarse.greville(i), grid.v.coarse.greville(j));
        }
        for (int di = -1; di <= 1; ++di) {
          for (int dj = -1; dj <= 1; ++dj) {
            if (i + di < 0 || i + di >= nu || j + dj < 0 || j + dj >= nv) continue;
            const int other = coefficient(static_cast<int>(q), i + di, j + dj);
            if (other != c) neighbours[at].insert(other);
          }
        }
      }
    }
  }
  neighbours_.reserve(count);
  for (const std::set<int>& set : neighbours) neighbours_.emplace_back(set.begin(), set.end());
}

void DisplacementSpace::lock_coefficient(int c, unsigned axes, const std::string& reason) {
  const auto at = static_cast<size_t>(c);
  const bool was_locked = locked_axes_[at] == kAllAxes;
  locked_axes_[at] |= axes;
  // The first reason stays, but what locks all axes says more than what locks one.
  if (lock_reason_of_[at] >= 0 && (was_locked || axes != kAllAxes)) return;
  const auto found = std::find(lock_reasons_.begin(), lock_reasons_.end(), reason);
  lock_reason_of_[at] = static_cast<int>(found - lock_reasons_.begin());
  if (found == lock_reasons_.end()) lock_reasons_.push_back(reason);
}

void DisplacementSpace::lock_points(const std::vector<int>& points, const std::string& reason) {
  for (int point : points) {
    const auto row = static_cast<size_t>(class_of_point_[static_cast<size_t>(point)]);
    for (const RowTerm& term : rows_[row]) {
      lock_coefficient(entries_[static_cast<size_t>(term.entry)].coefficient, kAllAxes, reason);
    }
  }
}

CoefficientRow DisplacementSpace::grid_row(int q, int i, int j) const {
  return {{coefficient(q, i, j)}, {signs(q, i, j)}, {}};
}

std::vector<Vec3> DisplacementSpace::expand(const std::vector<Vec3>& delta) const {
  ISOCHOR_REQUIRE(delta.size() == places_.size(), delta.size(), places_.size());
  std::vector<Vec3> by_class(rows_.size(), Vec3::Zero());
  for (size_t c = 0; c < rows_.size(); ++c) {
    for (const RowTerm& term : rows_[c]) {
      const Entry& entry = entries_[static_cast<size_t>(term.entry)];
      const Vec3& d = delta[static_cast<size_t>(entry.coefficient)];
      for (int a = 0; a < 3; ++a) {
        by_class[c][a] += term.value * (entry.flipped >> a & 1u ? -d[a] : d[a]);
      }
    }
  }
  std::vector<Vec3> displacement(class_of_point_.size());
  for (size_t i = 0; i < displacement.size(); ++i) {
    displacement[i] = by_class[static_cast<size_t>(class_of_point_[i])];
  }
  return displacement;
}

std::vector<Vec3> DisplacementSpace::gather(const std::vector<Vec3>& point_gradient) const {
  ISOCHOR_REQUIRE(point_gradient.size() == class_of_point_.size(), point_gradient.size());
  std::vector<Vec3> by_class(rows_.size(), Vec3::Zero());
  for (size_t i = 0; i < point_gradient.size(); ++i) {
    by_class[static_cast<size_t>(class_of_point_[i])] += point_gradient[i];
  }
  std::vector<Vec3> gradient(places_.size(), Vec3::Zero());
  for (size_t c = 0; c < rows_.size(); ++c) {
    for (const RowTerm& term : rows_[c]) {
      const Entry& entry = entries_[static_cast<size_t>(term.entry)];
      Vec3& g = gradient[static_cast<size_t>(entry.coefficient)];
      for (int a = 0; a < 3; ++a) {
        g[a] += term.value * (entry.flipped >> a & 1u ? -by_class[c][a] : by_class[c][a]);
      }
    }
  }
  return gradient;
}

std::vector<int> DisplacementSpace::moved_points(const std::vector<char>& coefficients) const {
  std::vector<char> moved(rows_.size(), 0);
  for (size_t c = 0; c < rows_.size(); ++c) {
    for (const RowTerm& term : rows_[c]) {
      const int k = entries_[static_cast<size_t>(term.entry)].coefficient;
      if (coefficients[static_cast<size_t>(k)]) moved[c] = 1;
    }
  }
  std::vector<int> points;
  for (size_t i = 0; i < class_of_point_.size(); ++i) {
    if (moved[static_cast<size_t>(class_of_point_[i])]) points.push_back(static_cast<int>(i));
  }
  return points;
}

}  // namespace isochor
