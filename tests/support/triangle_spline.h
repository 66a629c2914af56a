// The smoothness conditions of a C1 spline of triangular Bezier patches over a jittered grid: a
// large, sparse system of exact rows with the redundancies of a real one.
//
// Symbols: degree d >= 5; each triangle has the control points q_ijk, i + j + k = d, and neighbours
// share those of their edge. Over an edge between (v1, v2, v3) and (v4, v3, v2) there are d
// conditions, for j + k = d - 1,
//   |123| q'_1kj = |423| q_1jk + |143| q_0,j+1,k + |124| q_0,j,k+1,
// with |abc| twice the signed area, an integer since vertices lie on an integer grid (Rodrigues
// 2017, ch. 12). Around each interior vertex two conditions are redundant, three where four edges
// lie on two straight lines (*singular*): rank = d E_s - 2 V_int - singular for d >= 5.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isochor/ecles/constraint_matrix.h"
#include "isochor/ecles/relevant.h"

namespace isochor::testing {

struct TriangleSplineOptions {
  int degree = 5;
  int columns = 5, rows = 5;  // cells of the grid, two triangles each
  int bits = 12;              // vertices are multiples of 2^-bits of the larger side
  std::int64_t cell = 0;      // side of a cell in those units; 0: as large as the bits allow
  double jitter = 0.2;        // of a cell's side, at most, each way
  // Vertices and diagonals depend on the seed and their own place alone: a larger grid with the
  // same cell contains a smaller one.
  unsigned seed = 1;
};

class TriangleSpline {
 public:
  explicit TriangleSpline(const TriangleSplineOptions& options);

  int points() const;
  int triangles() const { return static_cast<int>(triangles_.size()); }
  const std::array<int, 3>& corners(int triangle) const {
    return triangles_[static_cast<size_t>(triangle)];
  }
  // In units of the grid that vertices lie on.
  std::array<std::int64_t, 2> position(int vertex) const;
  struct ControlPoint {
    int point = 0;
    std::array<int, 3> weights{};  // at the triangle's corners; their sum is the degree
  };
  std::vector<ControlPoint> control_points(int triangle) const;
  int vertex(int column, int row) const { return row * (options_.columns + 1) + column; }
  int middle() const { return vertex(options_.columns / 2, options_.rows / 2); }
  std::vector<RationalTerms> rows() const;
  ConstraintMatrix matrix() const { return {points(), rows()}; }

  int shared_edges() const;
  int interior_vertices() const;
  int singular_vertices() const;

  // One anchor, the point of a vertex; derived is what may follow when points up to the net
  // distance `radius` move: the discs (net distance <= 2) of each vertex whose disc they enter, and
  // the points beside each edge at such a vertex.
  Selection neighbourhood(int vertex, int radius) const;
  // One anchor, the point of a vertex; everything else is derived.
  Selection everything(int vertex) const;

 private:
  using Triangle = std::array<int, 3>;
  struct Position {
    std::int64_t x = 0, y = 0;
  };
  struct Edge {
    int low = 0, high = 0;                 // vertices, low < high
    std::array<int, 2> triangles{-1, -1};  // the second is -1 on the border
    std::array<int, 2> opposite{-1, -1};   // the vertex of each that is not on the edge
  };

  std::uint64_t random(int column, int row, int what) const;
  void place_vertices();
  void add_triangle(Triangle triangle);
  Integer area(int a, int b, int c) const;
  // The point with the given weights at the three vertices of a triangle.
  int point(int triangle, const std::array<int, 3>& vertices, std::array<int, 3> weights) const;
  bool is_singular(int vertex, const std::vector<int>& edges) const;
  std::vector<std::vector<int>> edges_of_vertices() const;

  TriangleSplineOptions options_;
  std::vector<Position> positions_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<int, 3>> triangle_edges_;  // opposite each vertex
  std::vector<Edge> edges_;
  std::vector<std::vector<std::pair<int, int>>> edge_from_;  // by low vertex: (high, edge)
};

}  // namespace isochor::testing
