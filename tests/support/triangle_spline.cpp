#include "support/triangle_spline.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace isochor::testing {
namespace {

size_t index(int i) { return static_cast<size_t>(i); }

}  // namespace

TriangleSpline::TriangleSpline(const TriangleSplineOptions& options) : options_(options) {
  if (options_.cell == 0) {
    options_.cell = (std::int64_t{1} << options_.bits) / std::max(options_.columns, options_.rows);
  }
  place_vertices();
  edge_from_.resize(positions_.size());
  for (int row = 0; row < options_.rows; ++row) {
    for (int column = 0; column < options_.columns; ++column) {
      const int a = vertex(column, row), b = vertex(column + 1, row);
      const int c = vertex(column + 1, row + 1), d = vertex(column, row + 1);
      if (random(column, row, 2) % 2 == 0) {
        add_triangle({a, b, c});
        add_triangle({a, c, d});
      } else {
        add_triangle({a, b, d});
        add_triangle({b, c, d});
      }
    }
  }
}

// The finaliser of splitmix64 over the place.
std::uint64_t TriangleSpline::random(int column, int row, int what) const {
  std::uint64_t z = (std::uint64_t{options_.seed} << 40) ^ (index(column) << 22) ^
                    (index(row) << 2) ^ index(what);
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

void TriangleSpline::place_vertices() {
  const auto reach =
      static_cast<std::int64_t>(std::floor(options_.jitter * static_cast<double>(options_.cell)));
  for (int row = 0; row <= options_.rows; ++row) {
    for (int column = 0; column <= options_.columns; ++column) {
      const auto jitter = [&](int what) {
        const auto choices = static_cast<std::uint64_t>(2 * reach + 1);
        return static_cast<std::int64_t>(random(column, row, what) % choices) - reach;
      };
      positions_.push_back({column * options_.cell + jitter(0), row * options_.cell + jitter(1)});
    }
  }
}

void TriangleSpline::add_triangle(Triangle triangle) {
  triangle_edges_.emplace_back();
  for (size_t corner = 0; corner < 3; ++corner) {
    const int a = triangle[(corner + 1) % 3], b = triangle[(corner + 2) % 3];
    const int low = std::min(a, b), high = std::max(a, b);
    auto& known = edge_from_[index(low)];
    auto found = std::find_if(known.begin(), known.end(),
                              [&](const auto& entry) { return entry.first == high; });
    if (found == known.end()) {
      found = known.insert(known.end(), {high, static_cast<int>(edges_.size())});
      edges_.push_back({low, high, {-1, -1}, {-1, -1}});
    }
    Edge& edge = edges_[index(found->second)];
    const size_t side = edge.triangles[0] < 0 ? 0 : 1;
    edge.triangles[side] = triangles();
    edge.opposite[side] = triangle[corner];
    triangle_edges_.back()[corner] = found->second;
  }
  triangles_.push_back(triangle);
}

int TriangleSpline::points() const {
  const int d = options_.degree;
  return static_cast<int>(positions_.size()) + (d - 1) * static_cast<int>(edges_.size()) +
         (d - 1) * (d - 2) / 2 * triangles();
}

int TriangleSpline::point(int triangle, const std::array<int, 3>& vertices,
                          std::array<int, 3> weights) const {
  const Triangle& corners = triangles_[index(triangle)];
  std::array<int, 3> at{};
  for (size_t k = 0; k < 3; ++k) {
    for (size_t corner = 0; corner < 3; ++corner) {
      if (corners[corner] == vertices[k]) at[corner] = weights[k];
    }
  }
  const int d = options_.degree, first_edge_point = static_cast<int>(positions_.size());
  for (size_t corner = 0; corner < 3; ++corner) {
    if (at[corner] == d) return corners[corner];
  }
  for (size_t corner = 0; corner < 3; ++corner) {
    if (at[corner] != 0) continue;
    const int edge = triangle_edges_[index(triangle)][corner];
    const size_t one = (corner + 1) % 3, other = (corner + 2) % 3;
    const int from_low =
        corners[one] == edges_[index(edge)].low ? at[other] : at[one];  // distance from low
    return first_edge_point + (d - 1) * edge + from_low - 1;
  }
  // Interior points of a triangle row by row of the first weight.
  const int i = at[0], j = at[1], per_triangle = (d - 1) * (d - 2) / 2;
  const int before = (i - 1) * (d - 1) - i * (i - 1) / 2;
  return first_edge_point + (d - 1) * static_cast<int>(edges_.size()) + per_triangle * triangle +
         before + j - 1;
}

std::array<std::int64_t, 2> TriangleSpline::position(int vertex) const {
  return {positions_[index(vertex)].x, positions_[index(vertex)].y};
}

std::vector<TriangleSpline::ControlPoint> TriangleSpline::control_points(int triangle) const {
  std::vector<ControlPoint> result;
  for (int i = 0; i <= options_.degree; ++i) {
    for (int j = 0; i + j <= options_.degree; ++j) {
      const std::array<int, 3> weights{i, j, options_.degree - i - j};
      result.push_back({point(triangle, corners(triangle), weights), weights});
    }
  }
  return result;
}

Integer TriangleSpline::area(int a, int b, int c) const {
  const Position &p = positions_[index(a)], &q = positions_[index(b)], &r = positions_[index(c)];
  return Integer(q.x - p.x) * Integer(r.y - p.y) - Integer(q.y - p.y) * Integer(r.x - p.x);
}

std::vector<RationalTerms> TriangleSpline::rows() const {
  std::vector<RationalTerms> result;
  for (const Edge& edge : edges_) {
    if (edge.triangles[1] < 0) continue;
    const auto [t, u] = edge.triangles;
    const auto [v1, v4] = edge.opposite;
    const int v2 = edge.low, v3 = edge.high;
    const Rational whole(area(v1, v2, v3)), one(area(v4, v2, v3)), two(area(v1, v4, v3)),
        three(area(v1, v2, v4));
    for (int j = options_.degree - 1; j >= 0; --j) {
      const int k = options_.degree - 1 - j;
      const std::array<int, 3> here{v1, v2, v3}, there{v4, v2, v3};
      result.push_back({{point(u, there, {1, j, k}), whole},
                        {point(t, here, {1, j, k}), -one},
                        {point(t, here, {0, j + 1, k}), -two},
                        {point(t, here, {0, j, k + 1}), -three}});
    }
  }
  return result;
}

int TriangleSpline::shared_edges() const {
  return static_cast<int>(std::count_if(edges_.begin(), edges_.end(),
                                        [](const Edge& e) { return e.triangles[1] >= 0; }));
}

int TriangleSpline::interior_vertices() const {
  return (options_.columns - 1) * (options_.rows - 1);
}

std::vector<std::vector<int>> TriangleSpline::edges_of_vertices() const {
  std::vector<std::vector<int>> result(positions_.size());
  for (size_t e = 0; e < edges_.size(); ++e) {
    result[index(edges_[e].low)].push_back(static_cast<int>(e));
    result[index(edges_[e].high)].push_back(static_cast<int>(e));
  }
  return result;
}

bool TriangleSpline::is_singular(int vertex, const std::vector<int>& edges) const {
  if (edges.size() != 4) return false;
  int straight = 0;
  for (size_t a = 0; a < 4; ++a) {
    if (edges_[index(edges[a])].triangles[1] < 0) return false;
    for (size_t b = a + 1; b < 4; ++b) {
      const Edge &e = edges_[index(edges[a])], &f = edges_[index(edges[b])];
      straight += area(vertex, e.low + e.high - vertex, f.low + f.high - vertex).is_zero() ? 1 : 0;
    }
  }
  return straight == 2;
}

int TriangleSpline::singular_vertices() const {
  const std::vector<std::vector<int>> edges = edges_of_vertices();
  int count = 0;
  for (size_t v = 0; v < edges.size(); ++v) {
    count += is_singular(static_cast<int>(v), edges[v]) ? 1 : 0;
  }
  return count;
}

Selection TriangleSpline::neighbourhood(int vertex, int radius) const {
  const int d = options_.degree, steps = (radius + 2) / d;
  const std::vector<std::vector<int>> edges = edges_of_vertices();
  std::set<int> moving{vertex};
  for (int step = 0; step < steps; ++step) {
    const std::set<int> before = moving;
    for (const int v : before) {
      for (const int e : edges[index(v)]) {
        moving.insert(edges_[index(e)].low);
        moving.insert(edges_[index(e)].high);
      }
    }
  }
  std::set<int> derived;
  for (const int v : moving) {
    for (const int e : edges[index(v)]) {
      const Edge& edge = edges_[index(e)];
      const int other = edge.low + edge.high - v;
      for (size_t side = 0; side < 2 && edge.triangles[side] >= 0; ++side) {
        const std::array<int, 3> corners{v, other, edge.opposite[side]};
        for (const std::array<int, 3>& near :
             {std::array<int, 3>{d, 0, 0}, {d - 1, 1, 0}, {d - 2, 2, 0}, {d - 2, 1, 1}}) {
          derived.insert(point(edge.triangles[side], corners, near));
        }
        for (int j = 2; j <= d - 3; ++j) {
          derived.insert(point(edge.triangles[side], corners, {j, d - 1 - j, 1}));
        }
      }
    }
  }
  derived.erase(vertex);
  return {{vertex}, {derived.begin(), derived.end()}};
}

Selection TriangleSpline::everything(int vertex) const {
  Selection selection{{vertex}, {}};
  for (int j = 0; j < points(); ++j) {
    if (j != vertex) selection.derived.push_back(j);
  }
  return selection;
}

}  // namespace isochor::testing
