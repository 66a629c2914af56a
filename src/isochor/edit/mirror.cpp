#include "isochor/edit/mirror.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace isochor {

std::vector<int> mirror_images(const std::vector<Vec3>& places, int axis, double tolerance) {
  const int key = (axis + 1) % 3;  // a coordinate that the mirror does not change
  std::vector<int> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key_of = [&](int i) { return places[static_cast<size_t>(i)][key]; };
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return key_of(a) != key_of(b) ? key_of(a) < key_of(b) : a < b; });
  std::vector<int> image(places.size(), -1);
  for (size_t i = 0; i < places.size(); ++i) {
    if (image[i] >= 0) continue;
    Vec3 wanted = places[i];
    wanted[axis] = -wanted[axis];
    if (std::abs(places[i][axis]) <= tolerance / 2) {  // on the plane: its own image
      image[i] = static_cast<int>(i);
      continue;
    }
    const auto from = std::lower_bound(order.begin(), order.end(), wanted[key] - tolerance,
                                       [&](int a, double value) { return key_of(a) < value; });
    int best = -1;
    double best_distance = tolerance;
    for (auto it = from; it != order.end() && key_of(*it) <= wanted[key] + tolerance; ++it) {
      const double distance = (places[static_cast<size_t>(*it)] - wanted).norm();
      const bool free = image[static_cast<size_t>(*it)] < 0 && *it != static_cast<int>(i);
      if (free && distance <= best_distance) {
        best = *it;
        best_distance = distance;
      }
    }
    if (best < 0) continue;
    image[i] = best;
    image[static_cast<size_t>(best)] = static_cast<int>(i);
  }
  return image;
}

}  // namespace isochor
