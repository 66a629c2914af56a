// The smoothness conditions of a quintic spline on a triangulated, jittered grid: a constraint
// system as the edits of bivariate splines meet it.
//
// The control point of a triangle (P, Q, L) with weights (i, j, k), i + j + k = 5, belongs to the
// point (i P + j Q + k L) / 5; points of shared edges and corners are shared. Two triangles
// (P, Q, L) and (P, Q, M) join with continuous derivatives when for s = 0..4
//   |PQL| m_s = |MQL| e_s + |PML| e_(s+1) + |PQM| l_s,
// |.| twice the signed area: integers, as the corners are. e_s lies on the edge, l_s and m_s beside
// it (Rodrigues 2017, 12.2; Lai, Schumaker, "Spline Functions on Triangulations", 2.10).
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "isochor/ecles/constraint_matrix.h"
#include "isochor/ecles/relevant.h"

namespace isochor::testing {

class C1Spline {
 public:
  using Corner = std::array<long, 2>;
  using Weights = std::vector<std::pair<int, int>>;  // (vertex, weight > 0), ascending

  // cells x cells squares with sides of `side` units, each cut along a random diagonal; corners
  // are moved by up to `jitter` units.
  C1Spline(int cells, long side, long jitter, std::mt19937& random) {
    std::uniform_int_distribution<long> shift(-jitter, jitter);
    for (int y = 0; y <= cells; ++y)
      for (int x = 0; x <= cells; ++x)
        vertices_.push_back({x * side + shift(random), y * side + shift(random)});
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) {
        const int a = y * (cells + 1) + x, b = a + 1, c = a + cells + 1, d = c + 1;
        if (random() % 2 == 0) {
          add_triangle(a, b, d);
          add_triangle(a, d, c);
        } else {
          add_triangle(a, b, c);
          add_triangle(b, d, c);
        }
      }
    add_rows();
  }

  int points() const { return static_cast<int>(weights_.size()); }
  int vertices() const { return static_cast<int>(vertices_.size()); }
  int shared_edges() const { return static_cast<int>(inner_.size()); }
  const std::vector<RationalTerms>& rows() const { return rows_; }
  // Where a point belongs: a solution of every row.
  Rational place(int point, int component) const {
    Integer sum;
    for (const auto& [v, w] : weights_[static_cast<size_t>(point)])
      sum += Integer(vertices_[static_cast<size_t>(v)][static_cast<size_t>(component)] * w);
    return {sum, Integer(5)};
  }

  // The vertex within two steps of the net, or -1.
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
      for (size_t t = 0; t < triangles_.size(); ++t) {
        const auto& triangle = triangles_[t];
        const auto touched = std::count_if(triangle.begin(), triangle.end(),
                                           [&](int v) { return corners.count(v) > 0; });
        if (touched < (step == 0 ? 3 : 1)) continue;
        next.insert(triangle.begin(), triangle.end());
        found.insert(points_of_[t].begin(), points_of_[t].end());
      }
      corners = std::move(next);
    }
    return {found.begin(), found.end()};
  }

  // Derived parameters that can follow the anchors whenever any can: all discs that S or A meets,
  // whole, and the two points beside the middle of every shared edge that meets these.
  std::vector<int> derived(const std::vector<int>& anchors, const std::vector<int>& s) const {
    std::set<int> result(s.begin(), s.end()), discs, touched(s.begin(), s.end());
    touched.insert(anchors.begin(), anchors.end());
    for (const int p : touched)
      if (disc_of(p) >= 0) discs.insert(disc_of(p));
    const std::set<int> held(anchors.begin(), anchors.end());
    for (const Inner& edge : inner_)
      if (held.count(edge.left) > 0 && held.count(edge.right) > 0)
        discs.insert({edge.from, edge.to});
    for (int p = 0; p < points(); ++p)
      if (discs.count(disc_of(p)) > 0) result.insert(p);
    for (const Inner& edge : inner_)
      if (discs.count(edge.from) + discs.count(edge.to) + touched.count(edge.left) +
              touched.count(edge.right) >
          0)
        result.insert({edge.left, edge.right});
    for (const int p : anchors) result.erase(p);
    return {result.begin(), result.end()};
  }

 private:
  struct Inner {
    int from, to, left, right;  // vertices, points beside the middle
  };

  void add_triangle(int a, int b, int c) {
    triangles_.push_back({a, b, c});
    points_of_.emplace_back();
    for (int i = 0; i <= 5; ++i)
      for (int j = 0; i + j <= 5; ++j) points_of_.back().push_back(point(a, i, b, j, c, 5 - i - j));
  }

  int point(int a, int i, int b, int j, int c, int k) {
    Weights weights;
    for (const auto& [v, w] : {std::pair{a, i}, std::pair{b, j}, std::pair{c, k}})
      if (w > 0) weights.emplace_back(v, w);
    std::sort(weights.begin(), weights.end());
    const auto [found, added] = numbers_.emplace(weights, points());
    if (added) weights_.push_back(weights);
    return found->second;
  }

  Integer area(int a, int b, int c) const {
    const auto &p = vertices_[static_cast<size_t>(a)], &q = vertices_[static_cast<size_t>(b)],
               &r = vertices_[static_cast<size_t>(c)];
    return {(q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])};
  }

  void add_rows() {
    std::map<std::pair<int, int>, std::vector<int>> opposite;
    for (const auto& t : triangles_)
      for (int k = 0; k < 3; ++k) {
        const int a = t[static_cast<size_t>(k)], b = t[static_cast<size_t>((k + 1) % 3)];
        opposite[{std::min(a, b), std::max(a, b)}].push_back(t[static_cast<size_t>((k + 2) % 3)]);
      }
    for (const auto& [edge, sides] : opposite) {
      if (sides.size() < 2) continue;
      const auto [p, q] = edge;
      const int l = sides[0], m = sides[1];
      for (int s = 0; s < 5; ++s)
        rows_.push_back({{point(p, 4 - s, q, s, m, 1), Rational(area(p, q, l))},
                         {point(p, 5 - s, q, s, q, 0), -Rational(area(m, q, l))},
                         {point(p, 4 - s, q, s + 1, q, 0), -Rational(area(p, m, l))},
                         {point(p, 4 - s, q, s, l, 1), -Rational(area(p, q, m))}});
      inner_.push_back({p, q, point(p, 2, q, 2, l, 1), point(p, 2, q, 2, m, 1)});
    }
  }

  std::vector<Corner> vertices_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<std::vector<int>> points_of_;
  std::map<Weights, int> numbers_;
  std::vector<Weights> weights_;
  std::vector<Inner> inner_;
  std::vector<RationalTerms> rows_;
};

}  // namespace isochor::testing
