#include "isochor/bspline/trims.h"

#include <algorithm>
#include <utility>

namespace isochor {
namespace {

// Where the loops cross the line v = const, ascending in u.
std::vector<double> crossings(const TrimRegion& trim, double v) {
  std::vector<double> at;
  for (const std::vector<Uv>& loop : trim.loops) {
    for (size_t i = 0; i < loop.size(); ++i) {
      const Uv& p = loop[i];
      const Uv& q = loop[(i + 1) % loop.size()];
      // Half-open, so that a vertex on the line counts once.
      if ((p.v <= v) == (q.v <= v)) continue;
      at.push_back(p.u + (v - p.v) / (q.v - p.v) * (q.u - p.u));
    }
  }
  std::sort(at.begin(), at.end());
  return at;
}

bool odd_before(const std::vector<double>& sorted, double u) {
  return (std::lower_bound(sorted.begin(), sorted.end(), u) - sorted.begin()) % 2 == 1;
}

// The elements whose interior an interval meets: [first, second).
std::pair<int, int> elements_met(const std::vector<double>& breaks, double low, double high) {
  const auto count = static_cast<int>(breaks.size()) - 1;
  // The first element that ends above `low`, and the first that begins at or above `high`. A
  // degenerate interval inside an element meets it; one on a break meets nothing.
  int first =
      static_cast<int>(std::upper_bound(breaks.begin(), breaks.end(), low) - breaks.begin()) - 1;
  int last =
      static_cast<int>(std::lower_bound(breaks.begin(), breaks.end(), high) - breaks.begin());
  first = std::clamp(first, 0, count);
  last = std::clamp(last, 0, count);
  return {first, std::max(first, last)};
}

// The elements in the support of function i: [first, second).
std::pair<int, int> support(const KnotVector& knots, const std::vector<double>& breaks, int i) {
  return elements_met(breaks, knots[i], knots[i + knots.degree() + 1]);
}

// Sums of a property over blocks of elements in O(1).
class BlockCount {
 public:
  BlockCount(const ElementGrid& grid, ElementKind kind)
      : stride_(grid.v_count + 1),
        sums_(static_cast<size_t>(grid.u_count + 1) * static_cast<size_t>(stride_), 0) {
    for (int a = 0; a < grid.u_count; ++a) {
      for (int b = 0; b < grid.v_count; ++b) {
        sum(a + 1, b + 1) =
            sum(a, b + 1) + sum(a + 1, b) - sum(a, b) + (grid.at(a, b) == kind ? 1 : 0);
      }
    }
  }
  int in(const std::pair<int, int>& u, const std::pair<int, int>& v) {
    return sum(u.second, v.second) - sum(u.first, v.second) - sum(u.second, v.first) +
           sum(u.first, v.first);
  }

 private:
  int& sum(int a, int b) { return sums_[static_cast<size_t>(a) * stride_ + b]; }
  int stride_;
  std::vector<int> sums_;
};

}  // namespace

ElementGrid classify_elements(const Patch& patch, const BoxRanges& released) {
  const std::vector<double> u = patch.u_knots.breaks();
  const std::vector<double> v = patch.v_knots.breaks();
  ElementGrid grid;
  grid.u_count = static_cast<int>(u.size()) - 1;
  grid.v_count = static_cast<int>(v.size()) - 1;
  grid.kinds.assign(static_cast<size_t>(grid.u_count) * static_cast<size_t>(grid.v_count),
                    ElementKind::kInside);
  if (patch.trim.empty()) return grid;
  const auto kind = [&](int a, int b) -> ElementKind& {
    return grid.kinds[static_cast<size_t>(a) * grid.v_count + b];
  };
  if (!patch.trim.loops.empty()) {
    for (int b = 0; b < grid.v_count; ++b) {
      const auto row = static_cast<size_t>(b);
      const std::vector<double> at = crossings(patch.trim, 0.5 * (v[row] + v[row + 1]));
      for (int a = 0; a < grid.u_count; ++a) {
        const auto column = static_cast<size_t>(a);
        if (!odd_before(at, 0.5 * (u[column] + u[column + 1]))) kind(a, b) = ElementKind::kOutside;
      }
    }
  }
  for (size_t k = 0; k < patch.trim.boundary.size(); ++k) {
    const UvBox& box = patch.trim.boundary[k];
    const bool may_move = contains(released, static_cast<int>(k));
    const auto [u_first, u_last] = elements_met(u, box.u_min, box.u_max);
    const auto [v_first, v_last] = elements_met(v, box.v_min, box.v_max);
    for (int a = u_first; a < u_last; ++a) {
      for (int b = v_first; b < v_last; ++b) {
        if (!may_move) kind(a, b) = ElementKind::kCrossed;
        if (kind(a, b) != ElementKind::kCrossed) kind(a, b) = ElementKind::kReleased;
      }
    }
  }
  return grid;
}

std::vector<TrimState> trim_states(const Patch& patch, const ElementGrid& elements) {
  const std::vector<double> u = patch.u_knots.breaks();
  const std::vector<double> v = patch.v_knots.breaks();
  BlockCount inside(elements, ElementKind::kInside);
  BlockCount outside(elements, ElementKind::kOutside);
  BlockCount crossed(elements, ElementKind::kCrossed);
  BlockCount released(elements, ElementKind::kReleased);
  std::vector<TrimState> states;
  states.reserve(patch.points.size());
  for (int i = 0; i < patch.u_size(); ++i) {
    const auto in_u = support(patch.u_knots, u, i);
    for (int j = 0; j < patch.v_size(); ++j) {
      const auto in_v = support(patch.v_knots, v, j);
      const int all = (in_u.second - in_u.first) * (in_v.second - in_v.first);
      const bool only_released = released.in(in_u, in_v) > 0 && crossed.in(in_u, in_v) == 0;
      const bool free = only_released || inside.in(in_u, in_v) == all;
      states.push_back(free                            ? TrimState::kFree
                       : outside.in(in_u, in_v) == all ? TrimState::kTrimmedOff
                                                       : TrimState::kNearTrim);
    }
  }
  return states;
}

bool contains(const BoxRanges& ranges, int box) {
  return std::any_of(ranges.begin(), ranges.end(),
                     [&](const auto& range) { return range.first <= box && box < range.second; });
}

BoxRanges released_boxes(const PatchModel& model, int q) {
  BoxRanges ranges;
  for (const SharedTrim& trim : model.shared_trims) {
    for (size_t k = 0; k < 2; ++k) {
      if (trim.released[k] && trim.patches[k] == q) ranges.push_back(trim.boxes[k]);
    }
  }
  return ranges;
}

bool side_is_released(const PatchModel& model, int locked_side) {
  return std::any_of(model.shared_trims.begin(), model.shared_trims.end(),
                     [&](const SharedTrim& trim) {
                       return (trim.released[0] && trim.locked_sides[0] == locked_side) ||
                              (trim.released[1] && trim.locked_sides[1] == locked_side);
                     });
}

bool corner_is_released(const PatchModel& model, int fixed_point) {
  return std::any_of(
      model.shared_trims.begin(), model.shared_trims.end(), [&](const SharedTrim& trim) {
        const auto& corners = trim.corners;
        return (trim.released[0] || trim.released[1]) &&
               std::find(corners.begin(), corners.end(), fixed_point) != corners.end();
      });
}

bool inside_trim(const TrimRegion& trim, double u, double v) {
  return trim.loops.empty() || odd_before(crossings(trim, v), u);
}

}  // namespace isochor
