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

}  // namespace

PatchModel make_revolved(const KnotVector& along,
                         const std::vector<std::pair<double, double>>& profile,
                         const std::vector<double>& weights) {
  PatchModel model;
  Patch patch{"", "face:1", four_arcs(), along, {}, {}, false, {}, {}};
  const size_t last = profile.size() - 1;
  const bool closed = profile.front() == profile.back();
  std::map<std::pair<size_t, size_t>, int> point_at;
  for (size_t i = 0; i < 9; ++i) {
    for (size_t j = 0; j <= last; ++j) {
      const auto [radius, height] = profile[j];
      const std::pair<size_t, size_t> key(radius == 0.0 ? 0 : i % 8, closed && j == last ? 0 : j);
      const auto [entry, fresh] = point_at.emplace(key, static_cast<int>(model.points.size()));
      if (fresh) {
        model.points.emplace_back(radius * kUnitCircle[i].x, radius * kUnitCircle[i].y, height);
      }
      patch.points.push_back(entry->second);
      patch.weights.push_back(kUnitCircle[i].w * (weights.empty() ? 1.0 : weights[j]));
    }
  }
  model.patches.push_back(std::move(patch));
  return model;
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
