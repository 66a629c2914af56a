#include "support/revolved.h"

#include <array>
#include <cmath>
#include <map>
#include <string>

namespace isochor::testing {
namespace {

// The unit circle: corners of the square around it have the weight of half a right angle.
struct CirclePole {
  double x, y, w;
};
const double kCorner = std::sqrt(0.5);
const std::array<CirclePole, 9> kUnitCircle = {{{1, 0, 1},
                                                {1, 1, kCorner},
                                                {0, 1, 1},
                                                {-1, 1, kCorner},
                                                {-1, 0, 1},
                                                {-1, -1, kCorner},
                                                {0, -1, 1},
                                                {1, -1, kCorner},
                                                {1, 0, 1}}};

KnotVector four_arcs() { return KnotVector(2, {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}); }

// Poles around, the first one again at the end.
std::vector<CirclePole> circle_poles(Circle circle) {
  if (circle != Circle::kCubic) return {kUnitCircle.begin(), kUnitCircle.end()};
  // Each arc elevated: the inner poles lie at w-weighted thirds.
  std::vector<CirclePole> poles = {kUnitCircle[0]};
  for (size_t arc = 0; arc < 4; ++arc) {
    const CirclePole& corner = kUnitCircle[2 * arc + 1];
    const auto inner = [&](const CirclePole& end) {
      const double w = (1.0 + 2.0 * kCorner) / 3.0;
      const double share = 2.0 * kCorner / (1.0 + 2.0 * kCorner);
      return CirclePole{end.x + share * (corner.x - end.x), end.y + share * (corner.y - end.y), w};
    };
    poles.push_back(inner(kUnitCircle[2 * arc]));
    poles.push_back(inner(kUnitCircle[2 * arc + 2]));
    poles.push_back(kUnitCircle[2 * arc + 2]);
  }
  return poles;
}

KnotVector circle_knots(Circle circle) {
  switch (circle) {
    case Circle::kQuadratic:
      return four_arcs();
    case Circle::kCubic:
      return KnotVector(3, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 4});
    case Circle::kPeriodic:
      return KnotVector(2, {-1, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5});
  }
  return four_arcs();
}

}  // namespace

PatchModel make_revolved(const KnotVector& along,
                         const std::vector<std::pair<double, double>>& profile,
                         const std::vector<double>& weights, Circle circle) {
  PatchModel model;
  Patch patch{"", "face:1", circle_knots(circle), along, {}, {}, false, {}, {}};
  const std::vector<CirclePole> around = circle_poles(circle);
  const size_t last = profile.size() - 1;
  const bool closed = profile.front() == profile.back();
  std::map<std::pair<size_t, size_t>, int> point_at;
  for (size_t i = 0; i < around.size(); ++i) {
    for (size_t j = 0; j <= last; ++j) {
      const auto [radius, height] = profile[j];
      const std::pair<size_t, size_t> key(radius == 0.0 ? 0 : i % (around.size() - 1),
                                          closed && j == last ? 0 : j);
      const auto [entry, fresh] = point_at.emplace(key, static_cast<int>(model.points.size()));
      if (fresh) model.points.emplace_back(radius * around[i].x, radius * around[i].y, height);
      patch.points.push_back(entry->second);
      patch.weights.push_back(around[i].w * (weights.empty() ? 1.0 : weights[j]));
    }
  }
  model.patches.push_back(std::move(patch));
  return model;
}

PatchModel make_nose(double radius, double length, Circle circle) {
  const double depth = 0.75 * length;
  return make_revolved(
      KnotVector(2, {0, 0, 0, 1, 1, 2, 2, 2}),
      {{0.0, 0.0}, {radius, 0.0}, {radius, depth}, {radius, 0.9 * length}, {radius, length}},
      {1.0, kCorner, 1.0, 1.0, 1.0}, circle);
}

PatchModel make_rational_torus(double major, double minor) {
  std::vector<std::pair<double, double>> profile;
  std::vector<double> weights;
  for (const CirclePole& pole : kUnitCircle) {
    profile.emplace_back(major + minor * pole.x, minor * pole.y);
    weights.push_back(pole.w);
  }
  return make_revolved(four_arcs(), profile, weights);
}

}  // namespace isochor::testing
