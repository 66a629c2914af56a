#include "isochor/volume/contraction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/parallel.h"
#include "isochor/base/tolerance.h"
#include "isochor/volume/compensated_sum.h"
#include "isochor/volume/element_fields.h"
#include "isochor/volume/precise_volume.h"
#include "isochor/volume/quadrature_choice.h"

namespace isochor {

using internal::Columns;
using internal::kLanes;
using internal::Pack;

namespace {

// A strip's buffers stay in the first two caches: at degree 3 about 60 kB.
constexpr int kStripColumns = 192;
constexpr int kRowsOfTask = 256;

IndexRange clipped(const IndexRange& range, int size) {
  return {std::max(0, range.begin), std::min(size, range.end)};
}

// A ring of equal rows of Packs.
class Ring {
 public:
  Ring(int rows, int length)
      : rows_(rows), length_(length), packs_(static_cast<size_t>(rows) * length) {}
  Pack* row(int k) { return &packs_[static_cast<size_t>((k + rows_) % rows_) * length_]; }
  int length() const { return length_; }

 private:
  int rows_;
  int length_;
  std::vector<Pack> packs_;
};

// The columns of a task as lanes of Packs, with e columns more on both sides. Columns beyond the
// grid repeat the last one: they meet zeros of the tensors only.
class Lanes {
 public:
  Lanes(const IndexRange& columns, int size, int e)
      : columns_(columns), size_(size), length_((columns.count() + kLanes - 1) / kLanes), e_(e) {}
  int length() const { return length_; }
  // Packs of a row with its neighbours.
  int row_length() const { return length_ + 2 * e_; }

  // Visits (column, t) for t = 0 .. row_length() - 1 of one lane with its neighbours, t from the
  // first neighbour on.
  template <typename Visit>
  void for_each_neighbour(int lane, const Visit& visit) const {
    const int first = columns_.begin + lane * length_ - e_;
    if (first >= 0 && first + row_length() <= size_) {
      for (int t = 0; t < row_length(); ++t) visit(first + t, t);
    } else {
      for (int t = 0; t < row_length(); ++t) visit(std::clamp(first + t, 0, size_ - 1), t);
    }
  }

  // Visits (column, t) for the task's own columns in one lane.
  template <typename Visit>
  void for_each_column(int lane, const Visit& visit) const {
    const int first = columns_.begin + lane * length_;
    const int count = std::min(length_, columns_.end - first);
    for (int t = 0; t < count; ++t) visit(first + t, t);
  }

  // tau^v in the order in which PairsArguments wants it.
  std::vector<Pack> tensor(const TauTensor& v) const {
    std::vector<Pack> packs;
    packs.reserve(static_cast<size_t>(length_) * internal::step_count(e_));
    for (int t = 0; t < length_; ++t) {
      for (int o = 0; o <= 2 * e_; ++o) {
        for (int s = internal::first_step(e_, o); s < internal::end_step(e_, o); ++s) {
          Pack pack{};
          for (int l = 0; l < kLanes; ++l) {
            const int column = columns_.begin + l * length_ + t;
            if (column < columns_.end) pack.lane[l] = v.band(o, s)[column];
          }
          packs.push_back(pack);
        }
      }
    }
    return packs;
  }

 private:
  IndexRange columns_;
  int size_;
  int length_;
  int e_;
};

// Asks for memory ahead of its use: rows of large grids are far apart, which processors do not
// foresee.
void prefetch(const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address);
#endif
}

// Axis a of the gradient needs the coordinates after it, in cyclic order.
template <Columns kColumns>
constexpr int kCoordinates = kColumns == Columns::kAll ? 3 : 2;

template <Columns kColumns>
void gather(const Lanes& lanes, const int* row, const int* next_row, int axis,
            const std::vector<Vec3>& all, Pack* out) {
  const Vec3* points = all.data();
  constexpr int kIn = kCoordinates<kColumns>;
  const int first = kColumns == Columns::kAll ? 0 : (axis + 1) % 3;
  const int second = kColumns == Columns::kAll ? 1 : (axis + 2) % 3;
  for (int l = 0; l < kLanes; ++l) {
    lanes.for_each_neighbour(l, [&](int column, int t) {
      const Vec3& p = points[row[column]];
      prefetch(&points[next_row[column]]);
      Pack* to = out + t * kIn;
      to[0].lane[l] = p[first];
      to[1].lane[l] = p[second];
      if constexpr (kIn == 3) to[2].lane[l] = p[2];
    });
  }
}

bool has_weights(const Patch& patch) {
  const auto& w = patch.weights;
  return std::any_of(w.begin(), w.end(), [&](double each) { return each != w[0]; });
}

// tau^u sorted by the row k that enters, see RowsArguments, times the sign of the patch.
std::vector<double> sorted_by_row(const TauTensor& u, double sign) {
  const int d = u.degree();
  std::vector<double> sorted;
  for (int k = 0; k < u.size(); ++k) {
    for (int j = k - d; j < k + d; ++j) {
      for (int i = k - d; i <= k + d; ++i) {
        const bool inside = 0 <= i && i < u.size() && 0 <= j && j + 1 < u.size();
        sorted.push_back(inside ? sign * u(i, k, j) : 0.0);
      }
    }
  }
  return sorted;
}

}  // namespace

VolumeContraction::VolumeContraction(const PatchModel& model, InstructionSet set)
    : set_(set), point_count_(model.points.size()), model_(model.patches) {
  internal::TableCache tables;
  std::vector<internal::PatchForm> forms;
  for (const Patch& patch : model.patches) {
    internal::require_poles(patch, point_count_);
    ISOCHOR_REQUIRE(!has_weights(patch), patch.handle);
    add_patch(patch);
    internal::PatchForm form;
    form.u = tables.get(patch.u_knots, exact_gauss_points(patch.u_knots.degree()));
    form.v = tables.get(patch.v_knots, exact_gauss_points(patch.v_knots.degree()));
    forms.push_back(std::move(form));
  }
  find_targets(point_count_);
  rim_ = internal::Rim(model, forms, 0.0);
  rim_elements_ = rim_.elements();
}

void VolumeContraction::add_patch(const Patch& patch) {
  PatchTensors tensors{TauTensor(patch.u_knots), TauTensor(patch.v_knots), {}, patch.points, {}};
  tensors.u_rows = sorted_by_row(tensors.u, patch.sign());
  for (int i = 0; i < patch.u_size(); i += kRowsOfTask) {
    for (int j = 0; j < patch.v_size(); j += kStripColumns) {
      tasks_.push_back({static_cast<int>(patches_.size()),
                        clipped({i, i + kRowsOfTask}, patch.u_size()),
                        clipped({j, j + kStripColumns}, patch.v_size())});
    }
  }
  patches_.push_back(std::move(tensors));
}

// Tasks write to places that no other task writes to: points that are used once get their row, the
// others get a slot for each use, which are added up afterwards in a fixed order.
void VolumeContraction::find_targets(size_t point_count) {
  std::vector<int> uses(point_count, 0);
  for (const PatchTensors& patch : patches_) {
    for (int id : patch.points) ++uses[static_cast<size_t>(id)];
  }
  unused_points_ = std::find(uses.begin(), uses.end(), 0) != uses.end();
  for (PatchTensors& patch : patches_) {
    patch.target = patch.points;
    for (int& id : patch.target) {
      if (uses[static_cast<size_t>(id)] == 1) continue;
      shared_points_.push_back(id);
      id = ~static_cast<int>(shared_points_.size() - 1);
    }
  }
}

// Walks down the rows k of poles of a task and a degree beyond, keeping what is under way in rings:
// positions of the rows to come, differences of rows, and the rows of the gradient that are
// growing. Every row of the gradient is added up in the same order, whatever the task it belongs
// to.
template <Columns kColumns, typename Sink>
double VolumeContraction::contract(const Task& task, int axis, const std::vector<Vec3>& points,
                                   const Sink& sink) const {
  constexpr int kIn = kCoordinates<kColumns>;
  constexpr int kOut = kColumns == Columns::kAll ? 3 : 1;
  const PatchTensors& patch = patches_[static_cast<size_t>(task.patch)];
  const int n = patch.u.size(), m = patch.v.size(), d = patch.u.degree(), e = patch.v.degree();
  const internal::Stages stages = internal::find_stages(set_, kColumns, d, e);
  const Lanes lanes(task.columns, m, e);
  const int width = kIn * lanes.row_length();
  const std::vector<Pack> tau = lanes.tensor(patch.v);

  Ring positions(d + 2, width), along(2 * d, width), growing(2 * d + 1, kOut * lanes.length());
  std::vector<Pack> steps(static_cast<size_t>(width)),
      unused(growing.row(0), growing.row(0) + growing.length());
  const std::vector<Pack> nothing(static_cast<size_t>(width), Pack{});
  std::vector<Pack> pairs(static_cast<size_t>(kIn) * lanes.length() * (2 * e + 1));
  const internal::PairsArguments along_v{e, lanes.length(), tau.data(), steps.data(), pairs.data()};
  std::vector<const Pack*> along_u(static_cast<size_t>(2) * d);
  std::vector<Pack*> rows(static_cast<size_t>(2) * d + 1);

  const IndexRange walk = clipped({task.rows.begin - d, task.rows.end + d}, n);
  int next = std::max(0, walk.begin - d);  // the first row whose positions are not there yet
  const auto enter_rows_until = [&](int last) {
    for (; next <= std::min(last, n - 1); ++next) {
      Pack* here = positions.row(next);
      const int* row = &patch.points[static_cast<size_t>(next) * m];
      gather<kColumns>(lanes, row, next + 1 < n ? row + m : row, axis, points, here);
      if (next > std::max(0, walk.begin - d)) {
        stages.subtract(here, positions.row(next - 1), width, along.row(next - 1));
      }
    }
  };
  internal::CompensatedSum sum;
  const auto emit = [&](int i) {
    Pack* row = growing.row(i);
    const size_t start = static_cast<size_t>(i) * m;
    double parts[kLanes] = {};
    for (int l = 0; l < kLanes; ++l) {
      double part = 0.0;
      lanes.for_each_column(l, [&](int column, int t) {
        std::array<double, static_cast<size_t>(kOut)> entry;
        for (int c = 0; c < kOut; ++c) entry[static_cast<size_t>(c)] = row[t * kOut + c].lane[l];
        part += sink(start + static_cast<size_t>(column), entry);
      });
      parts[l] = part;
    }
    sum.add((parts[0] + parts[1]) + (parts[2] + parts[3]));
    std::fill(row, row + growing.length(), Pack{});
  };
  for (int k = walk.begin; k < walk.end; ++k) {
    enter_rows_until(k + d);
    stages.subtract(positions.row(k) + kIn, positions.row(k), width - kIn, steps.data());
    stages.pairs(along_v);
    for (int a = 0; a < 2 * d; ++a) {
      const int j = k - d + a;
      along_u[static_cast<size_t>(a)] = 0 <= j && j + 1 < n ? along.row(j) : nothing.data();
    }
    for (int b = 0; b <= 2 * d; ++b) {
      const int i = k - d + b;
      const bool wanted = task.rows.begin <= i && i < task.rows.end;
      rows[static_cast<size_t>(b)] = wanted ? growing.row(i) : unused.data();
    }
    const double* factors = &patch.u_rows[static_cast<size_t>(k) * 2 * d * (2 * d + 1)];
    stages.rows({d, 2 * e + 1, lanes.length(), pairs.data(), along_u.data(), factors, rows.data()});
    if (k - d >= task.rows.begin) emit(k - d);
  }
  for (int i = std::max(task.rows.begin, walk.end - d); i < task.rows.end; ++i) emit(i);
  return sum.total();
}

double VolumeContraction::origin(const std::vector<Vec3>& points, double height) const {
  // Third components sum to zero on a closed model: heights may be measured from any of its points.
  const bool free = closed() && !patches_.empty() && !patches_.front().points.empty();
  return free ? points[static_cast<size_t>(patches_.front().points.front())].z() : height;
}

void VolumeContraction::add_rim(const std::vector<Vec3>& points, double height,
                                std::vector<Vec3>& rows) const {
  if (rim_elements_.empty()) return;
  std::vector<int> all(points.size());
  std::iota(all.begin(), all.end(), 0);
  rim_.add_flux_gradient(points, rim_elements_, all, height, rows);
}

void VolumeContraction::value_and_gradient(const std::vector<Vec3>& points, double height,
                                           int threads, ValueAndGradient& result) const {
  ISOCHOR_REQUIRE(points.size() == point_count_, points.size(), point_count_);
  std::vector<Vec3>& rows = result.gradient;
  rows.resize(points.size());
  if (unused_points_) std::fill(rows.begin(), rows.end(), Vec3::Zero());
  for (int id : shared_points_) rows[static_cast<size_t>(id)].setZero();
  std::vector<Vec3> shared(shared_points_.size());
  std::vector<double> parts(tasks_.size());
  const double zero = origin(points, height);
  run_tasks(static_cast<int>(tasks_.size()), threads, [&](int k) {
    const Task& task = tasks_[static_cast<size_t>(k)];
    const PatchTensors& patch = patches_[static_cast<size_t>(task.patch)];
    // Plain pointers and numbers, which the loop over the poles keeps in registers.
    const auto sink = [ids = patch.points.data(), targets = patch.target.data(), at = points.data(),
                       out = rows.data(), uses = shared.data(),
                       zero](size_t place, const std::array<double, 3>& area) {
      const int target = targets[place];
      Vec3& row = target >= 0 ? out[target] : uses[~target];
      row = Vec3(area[0], area[1], area[2]);
      return (at[ids[place]].z() - zero) * area[2];
    };
    parts[static_cast<size_t>(k)] = contract<Columns::kAll>(task, 0, points, sink);
  });
  for (size_t k = 0; k < shared.size(); ++k) {
    rows[static_cast<size_t>(shared_points_[k])] += shared[k];
  }
  add_rim(points, height, rows);
  internal::CompensatedSum sum;
  for (double part : parts) sum.add(part);
  result.value = sum.total();
}

ValueAndGradient VolumeContraction::value_and_gradient(const std::vector<Vec3>& points,
                                                       double height, int threads) const {
  ValueAndGradient result;
  value_and_gradient(points, height, threads, result);
  return result;
}

double VolumeContraction::value(const std::vector<Vec3>& points, double height, int threads) const {
  ISOCHOR_REQUIRE(points.size() == point_count_, points.size(), point_count_);
  std::vector<double> parts(tasks_.size());
  const double zero = origin(points, height);
  run_tasks(static_cast<int>(tasks_.size()), threads, [&](int k) {
    const Task& task = tasks_[static_cast<size_t>(k)];
    const PatchTensors& patch = patches_[static_cast<size_t>(task.patch)];
    const auto sink = [ids = patch.points.data(), at = points.data(), zero](
                          size_t place, const std::array<double, 1>& area) {
      return (at[ids[place]].z() - zero) * area[0];
    };
    parts[static_cast<size_t>(k)] = contract<Columns::kOne>(task, 2, points, sink);
  });
  internal::CompensatedSum sum;
  for (double part : parts) sum.add(part);
  return sum.total();
}

Bounded VolumeContraction::bounded_value(const std::vector<Vec3>& points, double height) const {
  const double sum = value(points, height);
  const double zero = origin(points, height);
  double bound = 3.0 * kUnitRoundoff * std::abs(sum);
  for (const Patch& patch : model_) {
    const int d = patch.u_knots.degree(), e = patch.v_knots.degree();
    // Two tensors, two differences; the sums of the three stages; height, product and the sum over
    // a row of a task.
    const double steps = 2.0 + (2.0 * e + 1.0) + (4.0 * e + 3.0) +
                         (2.0 * d * (2.0 * d + 1.0) + 1.0) + (0.25 * kStripColumns + 6.0);
    const double factor = tau_error(d) + tau_error(e) + steps * kUnitRoundoff;
    bound += 1.01 * factor * contraction_majorant(patch, points, zero);
  }
  return {sum, bound};
}

std::vector<double> VolumeContraction::gradient_column(const std::vector<Vec3>& points, int axis,
                                                       double height, int threads) const {
  ISOCHOR_REQUIRE(points.size() == point_count_, points.size(), point_count_);
  ISOCHOR_REQUIRE(0 <= axis && axis < 3, axis);
  std::vector<double> column(points.size(), 0.0);
  std::vector<double> shared(shared_points_.size());
  run_tasks(static_cast<int>(tasks_.size()), threads, [&](int k) {
    const Task& task = tasks_[static_cast<size_t>(k)];
    const PatchTensors& patch = patches_[static_cast<size_t>(task.patch)];
    const auto sink = [targets = patch.target.data(), out = column.data(), uses = shared.data()](
                          size_t place, const std::array<double, 1>& area) {
      const int target = targets[place];
      (target >= 0 ? out[target] : uses[~target]) = area[0];
      return 0.0;
    };
    contract<Columns::kOne>(task, axis, points, sink);
  });
  for (size_t k = 0; k < shared.size(); ++k) {
    column[static_cast<size_t>(shared_points_[k])] += shared[k];
  }
  if (!closed()) {
    // On top of the column, in the order in which it is added when there are three.
    std::vector<Vec3> rows(points.size(), Vec3::Zero());
    for (size_t i = 0; i < column.size(); ++i) rows[i][axis] = column[i];
    add_rim(points, height, rows);
    for (size_t i = 0; i < column.size(); ++i) column[i] = rows[i][axis];
  }
  return column;
}

void VolumeContraction::add_gradient(const std::vector<Vec3>& points,
                                     const std::vector<int>& row_of, double height,
                                     std::vector<Vec3>& rows) const {
  ISOCHOR_REQUIRE(points.size() == point_count_, points.size(), point_count_);
  ISOCHOR_REQUIRE(row_of.size() == point_count_, row_of.size(), point_count_);
  for (size_t q = 0; q < patches_.size(); ++q) {
    const PatchTensors& patch = patches_[q];
    const int m = patch.v.size();
    Task task{static_cast<int>(q), {patch.u.size(), 0}, {m, 0}};
    for (size_t k = 0; k < patch.points.size(); ++k) {
      if (row_of[static_cast<size_t>(patch.points[k])] < 0) continue;
      const int i = static_cast<int>(k) / m, j = static_cast<int>(k) % m;
      task.rows = {std::min(task.rows.begin, i), std::max(task.rows.end, i + 1)};
      task.columns = {std::min(task.columns.begin, j), std::max(task.columns.end, j + 1)};
    }
    const IndexRange columns = task.columns;
    for (int j = columns.begin; j < columns.end; j += kStripColumns) {
      task.columns = {j, std::min(columns.end, j + kStripColumns)};
      const auto sink = [&](size_t place, const std::array<double, 3>& area) {
        const int row = row_of[static_cast<size_t>(patch.points[place])];
        if (row >= 0) {
          rows[static_cast<size_t>(row)] += Vec3(area[0], area[1], area[2]);
        }
        return 0.0;
      };
      contract<Columns::kAll>(task, 0, points, sink);
    }
  }
  if (closed()) return;
  rim_.add_flux_gradient(points, rim_.elements_of(row_of), row_of, height, rows);
}

}  // namespace isochor
