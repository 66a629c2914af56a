#include "isochor/edit/extent_selection.h"

#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/edit/names.h"

namespace isochor {
namespace {

// Steps along the net, diagonals included, are at most 1.083 times longer than the straight line on
// a regular grid, and 1.53 times across a right-angled edge; more is "around the edge and back".
constexpr double kPathSlack = 1.6;

std::vector<char> select_rings(const DisplacementSpace& space, int rings,
                               const std::vector<ExtentSeed>& seeds) {
  std::vector<char> selected(static_cast<size_t>(space.size()), 0);
  std::vector<int> front;
  const auto add = [&](int c) {
    if (selected[static_cast<size_t>(c)]) return;
    selected[static_cast<size_t>(c)] = 1;
    front.push_back(c);
  };
  for (const ExtentSeed& seed : seeds) {
    for (int c : seed.coefficients) add(c);
  }
  for (int step = 0; step < rings; ++step) {
    const std::vector<int> border = std::exchange(front, {});
    for (int c : border) {
      for (int other : space.neighbours(c)) add(other);
    }
  }
  return selected;
}

// Shortest paths along the net from one seed, not longer than `longest`.
void select_radius(const DisplacementSpace& space, double radius, const ExtentSeed& seed,
                   std::vector<char>& selected) {
  const double longest = kPathSlack * radius;
  std::vector<double> path(static_cast<size_t>(space.size()),
                           std::numeric_limits<double>::infinity());
  using Item = std::pair<double, int>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  const auto reach = [&](int c, double length) {
    if (length > longest || length >= path[static_cast<size_t>(c)]) return;
    path[static_cast<size_t>(c)] = length;
    queue.emplace(length, c);
  };
  for (int c : seed.coefficients) reach(c, (space.place(c) - seed.position).norm());
  while (!queue.empty()) {
    const auto [length, c] = queue.top();
    queue.pop();
    if (length > path[static_cast<size_t>(c)]) continue;
    if ((space.place(c) - seed.position).norm() <= radius) selected[static_cast<size_t>(c)] = 1;
    for (int other : space.neighbours(c)) {
      reach(other, length + (space.place(other) - space.place(c)).norm());
    }
  }
}

// Even-odd rule; corners of the polygon in parameter order.
bool inside_loop(const std::vector<Uv>& loop, double u, double v) {
  bool inside = false;
  for (size_t k = 0; k < loop.size(); ++k) {
    const Uv& a = loop[k];
    const Uv& b = loop[(k + 1) % loop.size()];
    if ((a.v > v) == (b.v > v)) continue;
    if (u < a.u + (v - a.v) / (b.v - a.v) * (b.u - a.u)) inside = !inside;
  }
  return inside;
}

// Selects the grid entries of patch q whose Greville abscissae satisfy `wanted`.
template <typename Wanted>
void select_grid(const DisplacementSpace& space, int q, std::vector<char>& selected,
                 Wanted wanted) {
  const KnotVector& u = space.u_knots(q);
  const KnotVector& v = space.v_knots(q);
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      if (wanted(u.greville(i), v.greville(j))) {
        selected[static_cast<size_t>(space.coefficient(q, i, j))] = 1;
      }
    }
  }
}

void select_points(const PatchModel& model, const DisplacementSpace& space,
                   const std::vector<int>& points, std::vector<char>& selected) {
  std::vector<char> wanted(model.points.size(), 0);
  for (int id : points) {
    if (id < 0 || static_cast<size_t>(id) >= model.points.size()) {
      throw InputError("", "extent.points",
                       "no point " + std::to_string(id) + " in the table of " +
                           std::to_string(model.points.size()));
    }
    wanted[static_cast<size_t>(id)] = 1;
  }
  for (size_t q = 0; q < model.patches.size(); ++q) {
    const Patch& patch = model.patches[q];
    const int patch_index = static_cast<int>(q);
    if (space.u_knots(patch_index) != patch.u_knots ||
        space.v_knots(patch_index) != patch.v_knots) {
      throw InputError("", "extent.points",
                       "point ids name coefficients only at the finest scale; use \"poles\"");
    }
    for (int i = 0; i < patch.u_size(); ++i) {
      for (int j = 0; j < patch.v_size(); ++j) {
        if (!wanted[static_cast<size_t>(patch.point(i, j))]) continue;
        selected[static_cast<size_t>(space.coefficient(patch_index, i, j))] = 1;
      }
    }
  }
}

void select_poles(const PatchModel& model, const DisplacementSpace& space, const Extent& extent,
                  std::vector<char>& selected) {
  for (const auto& [name, list] : extent.poles) {
    const int q = find_patch(model, name);
    for (const auto& [i, j] : list) {
      if (i < 0 || j < 0 || i >= space.u_knots(q).size() || j >= space.v_knots(q).size()) {
        throw InputError("", "extent.poles." + name,
                         "index [" + std::to_string(i) + ", " + std::to_string(j) +
                             "] is outside the grid of " + std::to_string(space.u_knots(q).size()) +
                             " x " + std::to_string(space.v_knots(q).size()) +
                             " coefficients of the chosen scale");
      }
      selected[static_cast<size_t>(space.coefficient(q, i, j))] = 1;
    }
  }
}

}  // namespace

std::vector<char> select_extent(const PatchModel& model, const DisplacementSpace& space,
                                const Extent& extent, const std::vector<ExtentSeed>& seeds) {
  std::vector<char> selected(static_cast<size_t>(space.size()), 0);
  switch (extent.kind) {
    case Extent::Kind::kRings:
      return select_rings(space, extent.rings, seeds);
    case Extent::Kind::kRadius:
      for (const ExtentSeed& seed : seeds) select_radius(space, extent.radius, seed, selected);
      break;
    case Extent::Kind::kLoop:
      select_grid(space, find_patch(model, extent.patch), selected,
                  [&](double u, double v) { return inside_loop(extent.loop, u, v); });
      break;
    case Extent::Kind::kBox:
      select_grid(space, find_patch(model, extent.patch), selected, [&](double u, double v) {
        return extent.u[0] <= u && u <= extent.u[1] && extent.v[0] <= v && v <= extent.v[1];
      });
      break;
    case Extent::Kind::kPoints:
      select_points(model, space, extent.points, selected);
      break;
    case Extent::Kind::kPoles:
      select_poles(model, space, extent, selected);
      break;
    case Extent::Kind::kFaces:
      for (const std::string& name : extent.faces) {
        select_grid(space, find_patch(model, name), selected, [](double, double) { return true; });
      }
      break;
    case Extent::Kind::kAll:
      selected.assign(selected.size(), 1);
      break;
  }
  return selected;
}

}  // namespace isochor
