#include "isochor/edit/mirror.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "isochor/base/error.h"

namespace isochor {
namespace {

class Matcher {
 public:
  Matcher(const std::vector<Vec3>& places, int axis, double tolerance)
      : places_(places), axis_(axis), key_((axis + 1) % 3), tolerance_(tolerance) {
    order_.resize(places.size());
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(),
              [&](int a, int b) { return key_of(a) != key_of(b) ? key_of(a) < key_of(b) : a < b; });
    image_.assign(places.size(), -1);
  }

  // Pairs what has no image yet with the nearest such place that `allowed` accepts.
  template <typename Allowed>
  void match(const Allowed& allowed) {
    for (size_t i = 0; i < places_.size(); ++i) {
      if (image_[i] >= 0) continue;
      if (std::abs(places_[i][axis_]) <= tolerance_ / 2) {  // on the plane: its own image
        image_[i] = static_cast<int>(i);
        continue;
      }
      const int best = nearest(i, allowed);
      if (best < 0) continue;
      image_[i] = best;
      image_[static_cast<size_t>(best)] = static_cast<int>(i);
    }
  }

  std::vector<int> take() { return std::move(image_); }

 private:
  // A coordinate that the mirror does not change.
  double key_of(int i) const { return places_[static_cast<size_t>(i)][key_]; }

  template <typename Allowed>
  int nearest(size_t i, const Allowed& allowed) const {
    Vec3 wanted = places_[i];
    wanted[axis_] = -wanted[axis_];
    const auto from = std::lower_bound(order_.begin(), order_.end(), wanted[key_] - tolerance_,
                                       [&](int a, double value) { return key_of(a) < value; });
    int best = -1;
    double best_distance = tolerance_;
    for (auto it = from; it != order_.end() && key_of(*it) <= wanted[key_] + tolerance_; ++it) {
      const auto j = static_cast<size_t>(*it);
      if (image_[j] >= 0 || j == i || !allowed(i, j)) continue;
      const double distance = (places_[j] - wanted).norm();
      if (distance <= best_distance) {
        best = *it;
        best_distance = distance;
      }
    }
    return best;
  }

  const std::vector<Vec3>& places_;
  int axis_;
  int key_;
  double tolerance_;
  std::vector<int> order_;
  std::vector<int> image_;
};

}  // namespace

std::vector<int> mirror_images(const std::vector<Vec3>& places, int axis, double tolerance,
                               const std::vector<int>& groups) {
  ISOCHOR_REQUIRE(groups.empty() || groups.size() == places.size(), groups.size(), places.size());
  Matcher matcher(places, axis, tolerance);
  if (!groups.empty()) {
    matcher.match([&](size_t i, size_t j) { return groups[i] == groups[j]; });
  }
  matcher.match([](size_t, size_t) { return true; });
  return matcher.take();
}

}  // namespace isochor
