// Edits of a quintic C1 spline: where control points are at rest, neighbourhoods of anchors, and
// which points have to follow.
//
// A point with the weights w_v at the vertices v of its triangle rests at sum w_v v / 5, and all
// points at rest satisfy every row. The *disc* of a vertex: the points with weight 3 or more there;
// discs do not meet. Rows lie in one disc, or across the middle of an edge, with a point of their
// own on each side of it.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "support/triangle_spline.h"

namespace isochor::testing {

class SplineEdits {
 public:
  explicit SplineEdits(const TriangleSpline& spline) : spline_(spline) {
    weights_.resize(static_cast<size_t>(spline.points()));
    std::map<std::pair<int, int>, std::vector<int>> beside;  // by edge: weights 2, 2, 1
    for (int t = 0; t < spline.triangles(); ++t) {
      for (const auto& [point, weights] : spline.control_points(t)) {
        auto& own = weights_[static_cast<size_t>(point)];
        own.clear();
        std::vector<int> twos;
        for (size_t k = 0; k < 3; ++k) {
          if (weights[k] > 0) own.emplace_back(spline.corners(t)[k], weights[k]);
          if (weights[k] == 2) twos.push_back(spline.corners(t)[k]);
        }
        if (twos.size() == 2)
          beside[{std::min(twos[0], twos[1]), std::max(twos[0], twos[1])}].push_back(point);
      }
    }
    for (const auto& [edge, points] : beside)
      if (points.size() == 2) middles_.push_back({edge.first, edge.second, points[0], points[1]});
  }

  const TriangleSpline& spline() const { return spline_; }

  Rational place(int point, int component) const {
    Integer sum;
    for (const auto& [v, w] : weights_[static_cast<size_t>(point)])
      sum.add_product(Integer(spline_.position(v)[static_cast<size_t>(component)]), w);
    return {sum, Integer(5)};
  }

  // The vertex of the disc that a point is in, or -1.
  int disc_of(int point) const {
    for (const auto& [v, w] : weights_[static_cast<size_t>(point)])
      if (w >= 3) return v;
    return -1;
  }

  // The points of all triangles within `radius` steps (over shared corners) of the anchors.
  std::vector<int> neighbourhood(const std::vector<int>& anchors, int radius) const {
    std::set<int> corners, found;
    for (const int p : anchors)
      for (const auto& entry : weights_[static_cast<size_t>(p)]) corners.insert(entry.first);
    for (int step = 0; step <= radius; ++step) {
      std::set<int> next = corners;
      for (int t = 0; t < spline_.triangles(); ++t) {
        const auto& triangle = spline_.corners(t);
        const auto touched = std::count_if(triangle.begin(), triangle.end(),
                                           [&](int v) { return corners.count(v) > 0; });
        if (touched < (step == 0 ? 3 : 1)) continue;
        next.insert(triangle.begin(), triangle.end());
        for (const auto& entry : spline_.control_points(t)) found.insert(entry.point);
      }
      corners = std::move(next);
    }
    return {found.begin(), found.end()};
  }

  // Derived points that can follow the anchors whenever any can: s, all discs that s or the anchors
  // meet, whole, and the points beside every edge that meets these.
  std::vector<int> derived(const std::vector<int>& anchors, const std::vector<int>& s) const {
    std::set<int> result(s.begin(), s.end()), discs, touched(s.begin(), s.end());
    touched.insert(anchors.begin(), anchors.end());
    for (const int p : touched)
      if (disc_of(p) >= 0) discs.insert(disc_of(p));
    const std::set<int> held(anchors.begin(), anchors.end());
    for (const Middle& edge : middles_)
      if (held.count(edge.left) > 0 && held.count(edge.right) > 0)
        discs.insert({edge.from, edge.to});
    for (int p = 0; p < spline_.points(); ++p)
      if (discs.count(disc_of(p)) > 0) result.insert(p);
    for (const Middle& edge : middles_)
      if (discs.count(edge.from) + discs.count(edge.to) + touched.count(edge.left) +
              touched.count(edge.right) >
          0)
        result.insert({edge.left, edge.right});
    for (const int p : anchors) result.erase(p);
    return {result.begin(), result.end()};
  }

 private:
  struct Middle {
    int from, to, left, right;  // vertices, points beside the middle
  };

  TriangleSpline spline_;
  std::vector<std::vector<std::pair<int, int>>> weights_;  // (vertex, weight > 0)
  std::vector<Middle> middles_;
};

// cells x cells squares with sides of 40 units and corners moved by up to 7: coefficients of at
// most twelve bits.
inline SplineEdits small_spline(int cells, unsigned seed) {
  TriangleSplineOptions options;
  options.columns = options.rows = cells;
  options.cell = 40;
  options.jitter = 0.18;
  options.seed = seed;
  return SplineEdits(TriangleSpline(options));
}

}  // namespace isochor::testing
