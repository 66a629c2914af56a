#include "isochor/bspline/closest_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/bspline/trims.h"

namespace isochor {
namespace {

constexpr int kMaxNewtonSteps = 60;
constexpr int kMaxElementMoves = 200;
constexpr int kMaxStarts = 12;

// One element, closed, and the objective on it: half the squared distance and its derivatives,
// with the limits from inside.
class Element {
 public:
  Element(const Surface& surface, const Vec3& target, int u_span, int v_span)
      : surface_(surface),
        target_(target),
        low_{surface.u_knots()[u_span], surface.v_knots()[v_span]},
        high_{surface.u_knots()[u_span + 1], surface.v_knots()[v_span + 1]} {}

  struct State {
    Eigen::Vector2d at;
    Vec3 point;
    double value = 0.0;
    Eigen::Vector2d gradient;
    Eigen::Matrix2d hessian;
    Eigen::Matrix2d gauss_newton;
  };

  State evaluate(const Eigen::Vector2d& at) const {
    const SurfaceDerivatives d = surface_.derivatives(at[0], at[1], 2, limit(0, at), limit(1, at));
    const Vec3 r = d.s - target_;
    State state;
    state.at = at;
    state.point = d.s;
    state.value = 0.5 * r.squaredNorm();
    state.gradient = {r.dot(d.su), r.dot(d.sv)};
    state.gauss_newton << d.su.dot(d.su), d.su.dot(d.sv), d.su.dot(d.sv), d.sv.dot(d.sv);
    state.hessian = state.gauss_newton;
    state.hessian(0, 0) += r.dot(d.suu);
    state.hessian(1, 1) += r.dot(d.svv);
    state.hessian(0, 1) += r.dot(d.suv);
    state.hessian(1, 0) = state.hessian(0, 1);
    return state;
  }

  Eigen::Vector2d clamped(const Eigen::Vector2d& at) const {
    return at.cwiseMax(low_).cwiseMin(high_);
  }
  // -1 at the lower bound, 1 at the upper one, else 0.
  int border(int axis, const Eigen::Vector2d& at) const {
    return at[axis] <= low_[axis] ? -1 : at[axis] >= high_[axis] ? 1 : 0;
  }
  // True when the objective falls towards the outside of a bound that is reached.
  bool held(int axis, const State& s) const {
    const int where = border(axis, s.at);
    return (where < 0 && s.gradient[axis] > 0.0) || (where > 0 && s.gradient[axis] < 0.0);
  }
  Eigen::Vector2d width() const { return high_ - low_; }

 private:
  Limit limit(int axis, const Eigen::Vector2d& at) const {
    return at[axis] >= high_[axis] ? Limit::kFromBelow : Limit::kFromAbove;
  }

  const Surface& surface_;
  Vec3 target_;
  Eigen::Vector2d low_, high_;
};

// The gradient without the components that a bound holds, in units of the element's widths.
double remaining_slope(const Element& element, const Element::State& s) {
  double slope = 0.0;
  for (int axis = 0; axis < 2; ++axis) {
    if (!element.held(axis, s)) {
      slope = std::max(slope, std::abs(s.gradient[axis]) * element.width()[axis]);
    }
  }
  return slope;
}

Eigen::Vector2d descent_step(const Element& element, const Element::State& s) {
  const bool held_u = element.held(0, s);
  const bool held_v = element.held(1, s);
  Eigen::Vector2d step = Eigen::Vector2d::Zero();
  if (held_u && held_v) return step;
  if (held_u || held_v) {
    const int free = held_u ? 1 : 0;
    const double curvature =
        s.hessian(free, free) > 0.0 ? s.hessian(free, free) : s.gauss_newton(free, free);
    if (curvature > 0.0) step[free] = -s.gradient[free] / curvature;
    return step;
  }
  for (const Eigen::Matrix2d& h : {s.hessian, s.gauss_newton}) {
    const double det = h(0, 0) * h(1, 1) - h(0, 1) * h(0, 1);
    if (h(0, 0) > 0.0 && h(1, 1) > 0.0 && det > kSingular * h(0, 0) * h(1, 1)) {
      step[0] = -(h(1, 1) * s.gradient[0] - h(0, 1) * s.gradient[1]) / det;
      step[1] = -(h(0, 0) * s.gradient[1] - h(0, 1) * s.gradient[0]) / det;
      return step;
    }
  }
  // Parallel derivatives (near a pole): each direction for itself, half way.
  for (int axis = 0; axis < 2; ++axis) {
    const double speed2 = s.gauss_newton(axis, axis);
    if (speed2 > 0.0) step[axis] = -0.5 * s.gradient[axis] / speed2;
  }
  return step;
}

// How much of the objective is rounding: coordinates carry an error of their own size, which the
// difference to the target keeps.
double noise_of(const Element::State& s) {
  const double distance = std::sqrt(2.0 * s.value);
  return 8.0 * kUnitRoundoff * distance * (distance + s.point.cwiseAbs().maxCoeff());
}

// Newton with bounds inside one element. A step is taken when it brings the surface nearer, or,
// where the distance itself is down to its rounding, when it makes the slope smaller.
Element::State minimise(const Element& element, const Eigen::Vector2d& start) {
  Element::State best = element.evaluate(element.clamped(start));
  for (int round = 0; round < kMaxNewtonSteps; ++round) {
    const Eigen::Vector2d step = descent_step(element, best);
    bool taken = false;
    double share = 1.0;
    for (int halving = 0; halving < 40 && !taken; ++halving, share *= 0.5) {
      const Eigen::Vector2d next = element.clamped(best.at + share * step);
      if (next == best.at) return best;
      const Element::State state = element.evaluate(next);
      const double noise = noise_of(best);
      const bool nearer = state.value < best.value - noise;
      const bool flatter = state.value <= best.value + noise &&
                           remaining_slope(element, state) < remaining_slope(element, best);
      if (nearer || flatter) {
        best = state;
        taken = true;
      }
    }
    if (!taken) return best;
  }
  return best;
}

// The minimum reached from an element, crossing knot lines as long as that brings it nearer.
ClosestPoint descend(const Surface& surface, const Vec3& p, int u_index, int v_index,
                     const Uv& start) {
  const auto& u_spans = surface.u_knots().spans();
  const auto& v_spans = surface.v_knots().spans();
  std::array<int, 2> index = {u_index, v_index};
  const std::array<int, 2> count = {static_cast<int>(u_spans.size()),
                                    static_cast<int>(v_spans.size())};
  const auto element_at = [&](const std::array<int, 2>& i) {
    return Element(surface, p, u_spans[static_cast<size_t>(i[0])],
                   v_spans[static_cast<size_t>(i[1])]);
  };
  Element::State best = minimise(element_at(index), {start.u, start.v});
  for (int move = 0; move < kMaxElementMoves; ++move) {
    const Element here = element_at(index);
    bool moved = false;
    for (int du = -1; du <= 1 && !moved; ++du) {
      for (int dv = -1; dv <= 1 && !moved; ++dv) {
        if (du == 0 && dv == 0) continue;
        if ((du != 0 && du != here.border(0, best.at)) ||
            (dv != 0 && dv != here.border(1, best.at))) {
          continue;
        }
        const std::array<int, 2> next = {index[0] + du, index[1] + dv};
        if (next[0] < 0 || next[1] < 0 || next[0] >= count[0] || next[1] >= count[1]) continue;
        const Element::State state = minimise(element_at(next), best.at);
        if (state.value < best.value - noise_of(best)) {
          best = state;
          index = next;
          moved = true;
        }
      }
    }
    if (!moved) break;
  }
  return {0, {best.at[0], best.at[1]}, best.point, (best.point - p).norm()};
}

// Parameters in every span, and which span each belongs to.
struct Samples {
  std::vector<double> at;
  std::vector<int> span;
};

Samples samples_of(const KnotVector& knots) {
  Samples samples;
  const int per_span = std::min(knots.degree(), 5) + 1;
  int index = 0;
  for (int k : knots.spans()) {
    for (int i = 0; i < per_span; ++i) {
      samples.at.push_back(knots[k] + (knots[k + 1] - knots[k]) * i / per_span);
      samples.span.push_back(index);
    }
    ++index;
  }
  samples.at.push_back(knots.end());
  samples.span.push_back(index - 1);
  return samples;
}

struct Start {
  double distance;
  size_t i, j;
};

// The grid samples that are nearer than their neighbours, nearest first.
std::vector<Start> starts_of(const std::vector<double>& distance, size_t rows, size_t columns) {
  std::vector<Start> starts;
  for (size_t i = 0; i < rows; ++i) {
    for (size_t j = 0; j < columns; ++j) {
      const double own = distance[i * columns + j];
      bool lowest = true;
      for (size_t a = i > 0 ? i - 1 : 0; a <= std::min(i + 1, rows - 1); ++a) {
        for (size_t b = j > 0 ? j - 1 : 0; b <= std::min(j + 1, columns - 1); ++b) {
          lowest = lowest && own <= distance[a * columns + b];
        }
      }
      if (lowest) starts.push_back({own, i, j});
    }
  }
  std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) {
    return a.distance != b.distance ? a.distance < b.distance
                                    : std::pair(a.i, a.j) < std::pair(b.i, b.j);
  });
  if (starts.size() > kMaxStarts) starts.resize(kMaxStarts);
  return starts;
}

void take_nearer(const ClosestPoint& candidate, ClosestPoint* best) {
  if (candidate.patch >= 0 && (best->patch < 0 || candidate.distance < best->distance)) {
    *best = candidate;
  }
}

ClosestPoint at_parameters(const Surface& surface, const Vec3& p, double u, double v) {
  const Vec3 point = surface.point(u, v);
  return {0, {u, v}, point, (point - p).norm()};
}

// How many samples lie strictly between two parameters.
int samples_between(const Samples& samples, double a, double b) {
  const auto first = std::upper_bound(samples.at.begin(), samples.at.end(), std::min(a, b));
  const auto last = std::lower_bound(first, samples.at.end(), std::max(a, b));
  return static_cast<int>(last - first);
}

// Makes *best the nearest point of the straight piece of parameters from a to b if it is nearer.
// Pieces are short: the distance along one has a single minimum.
void take_nearest_of_piece(const Surface& surface, const Vec3& p, const Uv& a, const Uv& b,
                           ClosestPoint* best) {
  constexpr int kThirdings = 60;
  const KnotVector& ku = surface.u_knots();
  const KnotVector& kv = surface.v_knots();
  const auto at = [&](double t) {
    return at_parameters(surface, p, std::clamp(a.u + t * (b.u - a.u), ku.begin(), ku.end()),
                         std::clamp(a.v + t * (b.v - a.v), kv.begin(), kv.end()));
  };
  const ClosestPoint middle = at(0.5);
  const ClosestPoint first = at(0.0);
  const double reach = (middle.point - first.point).norm();
  take_nearer(first, best);
  take_nearer(middle, best);
  if (middle.distance - 3.0 * reach > best->distance) return;
  double low = 0.0;
  double high = 1.0;
  for (int step = 0; step < kThirdings; ++step) {
    const double third = (high - low) / 3.0;
    if (at(low + third).distance < at(high - third).distance) {
      high -= third;
    } else {
      low += third;
    }
  }
  take_nearer(at(0.5 * (low + high)), best);
}

// The nearest point on the polylines of the trimming loops. Segments are cut so that each piece is
// no longer than the samples of the surface are apart.
ClosestPoint closest_on_loops(const Surface& surface, const TrimRegion& trim, const Vec3& p) {
  const Samples u = samples_of(surface.u_knots());
  const Samples v = samples_of(surface.v_knots());
  ClosestPoint best;
  for (const std::vector<Uv>& loop : trim.loops) {
    for (size_t i = 0; i < loop.size(); ++i) {
      const Uv& a = loop[i];
      const Uv& b = loop[(i + 1) % loop.size()];
      const int pieces = 1 + samples_between(u, a.u, b.u) + samples_between(v, a.v, b.v);
      const auto corner = [&](int k) {
        const double share = static_cast<double>(k) / pieces;
        return Uv{a.u + share * (b.u - a.u), a.v + share * (b.v - a.v)};
      };
      for (int k = 0; k < pieces; ++k) {
        take_nearest_of_piece(surface, p, corner(k), k + 1 == pieces ? b : corner(k + 1), &best);
      }
    }
  }
  return best;
}

double distance_to_pole_box(const PatchModel& model, const Patch& patch, const Vec3& p) {
  Vec3 low = model.points[static_cast<size_t>(patch.points.front())];
  Vec3 high = low;
  for (int id : patch.points) {
    low = low.cwiseMin(model.points[static_cast<size_t>(id)]);
    high = high.cwiseMax(model.points[static_cast<size_t>(id)]);
  }
  return (p - p.cwiseMax(low).cwiseMin(high)).norm();
}

}  // namespace

ClosestPoint closest_point(const Surface& surface, const Vec3& p) {
  return closest_point(surface, TrimRegion{}, p);
}

ClosestPoint closest_point(const Surface& surface, const TrimRegion& trim, const Vec3& p) {
  ISOCHOR_REQUIRE(p.allFinite(), p.x(), p.y(), p.z());
  const Samples u = samples_of(surface.u_knots());
  const Samples v = samples_of(surface.v_knots());
  const size_t rows = u.at.size();
  const size_t columns = v.at.size();
  std::vector<double> distance(rows * columns);
  ClosestPoint best;
  for (size_t i = 0; i < rows; ++i) {
    for (size_t j = 0; j < columns; ++j) {
      const ClosestPoint sample = at_parameters(surface, p, u.at[i], v.at[j]);
      distance[i * columns + j] = sample.distance;
      if (sample.distance < best.distance || best.patch < 0) {
        if (inside_trim(trim, u.at[i], v.at[j])) best = sample;
      }
    }
  }
  for (const Start& start : starts_of(distance, rows, columns)) {
    const ClosestPoint candidate =
        descend(surface, p, u.span[start.i], v.span[start.j], {u.at[start.i], v.at[start.j]});
    if (inside_trim(trim, candidate.uv.u, candidate.uv.v)) take_nearer(candidate, &best);
  }
  if (!trim.loops.empty()) take_nearer(closest_on_loops(surface, trim, p), &best);
  return best;
}

ClosestPoint closest_point(const PatchModel& model, const Vec3& p) {
  ISOCHOR_REQUIRE(p.allFinite(), p.x(), p.y(), p.z());
  std::vector<std::pair<double, int>> order;
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    order.emplace_back(distance_to_pole_box(model, model.patches[static_cast<size_t>(q)], p), q);
  }
  std::sort(order.begin(), order.end());
  ClosestPoint best;
  for (const auto& [at_least, q] : order) {
    if (best.patch >= 0 && at_least > best.distance) break;
    ClosestPoint candidate =
        closest_point(model.surface(q), model.patches[static_cast<size_t>(q)].trim, p);
    if (candidate.patch >= 0) candidate.patch = q;
    take_nearer(candidate, &best);
  }
  return best;
}

}  // namespace isochor
