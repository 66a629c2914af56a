// Bezier cells for section.h and below.h.
#pragma once

#include <array>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/volume/gauss.h"

namespace isochor::internal {

// Weighted coordinates (w X, w Y, w Z, w).
using Vec4 = Eigen::Vector4d;

// A tensor-product Bezier patch, u-major.
struct BezierCell {
  int u_degree = 1, v_degree = 1;
  std::vector<Vec4, Eigen::aligned_allocator<Vec4>> at;
  bool rational = false;

  Vec4& operator()(int i, int j) { return at[static_cast<size_t>(i * (v_degree + 1) + j)]; }
  const Vec4& operator()(int i, int j) const {
    return at[static_cast<size_t>(i * (v_degree + 1) + j)];
  }
  BezierCell transposed() const;
  std::array<BezierCell, 2> halves_in_u() const;
};

// Where frame coordinates come from.
struct Frame {
  Eigen::Matrix3d axes;  // rows a, b, n
  Vec3 origin;           // a point of the plane
};

// Axes a, b, n with a x b = n, and the point of the plane n.x = height nearest to the middle of the
// points.
Frame plane_frame(const std::vector<Vec3>& points, const Vec3& n, double height);
// The largest distance of a point from the frame's origin.
double reach_of(const std::vector<Vec3>& points, const Frame& frame);

// All elements of a patch as cells.
std::vector<BezierCell> cells_of(const Patch& patch, const std::vector<Vec3>& points,
                                 const Frame& frame);

// The rule with this many points; tables are made once.
const GaussRule& gauss_rule(int points);

// The largest weight is within this factor of the smallest in cells that one rule integrates.
inline constexpr double kWeightRatio = 2.0;
bool weights_vary(const BezierCell& cell);
// Whether w Z rises everywhere along u, or falls everywhere.
bool monotonic_in_u(const BezierCell& cell);

// Integrals of J, X J and Y J, and of their absolute values.
struct FluxLanes {
  std::array<double, 3> value{}, size{};
  void add(const FluxLanes& other, double factor);
};

// A point of a cell and its derivatives.
struct CellPoint {
  Vec3 at, along_u, along_v;
};

// A cell at one v: a Bezier curve in u with its derivative along v.
class CellLine {
 public:
  CellLine(const BezierCell& cell, double v);
  CellPoint point(double u) const;
  // w Z at u.
  double height(double u) const;
  // The one root of w Z in [0, 1]; its values at 0 and 1 have different signs.
  double root() const;
  // Over u from `from` to `to`.
  FluxLanes integral(double from, double to, const GaussRule& rule) const;

 private:
  int degree_;
  std::vector<Vec4, Eigen::aligned_allocator<Vec4>> value_, slope_;
};

// The roots in (0, 1) of the polynomial with these Bernstein coefficients, where it changes sign.
std::vector<double> sign_changes(const std::vector<double>& coefficients);

}  // namespace isochor::internal
