// A face cut into cells, finer on demand, each within proven bounds.
//
// A *cell* is a rectangle of parameters; its piece of surface lies within `radius` of the convex
// hull of its `hull` points. B-splines: the poles of the Bezier piece. Planes, cylinders, cones,
// spheres and tori: the four corners, and what second derivatives let the surface bulge from the
// bilinear patch between them, (du^2 max|S_uu| + dv^2 max|S_vv|) / 8.
//
// Laws (tests of those names in tests/step/face_cells_test.cpp):
//  (1) enclosure: every point of the face lies within the bounds of some cell of every level;
//  (2) trims: a cell is `outside` only when no point of it belongs to the face;
//  (3) whole: the children of a cell cover it.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <Geom2d_Curve.hxx>
#include <Geom_Surface.hxx>
#include <utility>
#include <vector>

#include "isochor/step/brep_table.h"
#include "isochor/volume/section_cells.h"

namespace isochor::internal {

struct Cell {
  UvBox uv;
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  // the box around hull and radius
  std::vector<Vec3> hull;
  double radius = 0.0;
  bool outside = false;
  int children = -1;       // index of the first of two; -1: none yet
  BezierCell bezier;       // of B-spline faces
  std::vector<int> trims;  // the pieces of trimming curves that may meet it

  double size() const { return (high - low).norm(); }
};

// A piece of a trimming curve inside a box of parameters; without a curve: a gap between two.
struct TrimPiece {
  Handle(Geom2d_Curve) curve;
  double first = 0.0, last = 0.0;
  Uv begin, end;
  UvBox box;
};

enum class Where { kInside, kOutside, kOnTrim };

class FaceCells {
 public:
  // `diagonal` of the shape: the unit of rounding.
  FaceCells(const FaceRecord& face, double diagonal);

  bool known() const { return !cells_.empty(); }  // false: no surface, or trims without curves
  bool proven() const { return proven_; }         // false: the bounds are estimates
  const Cell& root() const { return cells_.front(); }
  const Cell& cell(int k) const { return cells_[static_cast<size_t>(k)]; }
  // The first of the two children; -1 when it has too many cells already.
  int divide(int k);
  // Bytes that the division has taken, roughly; forget() gives them back.
  size_t bytes() const { return bytes_; }
  void forget();
  // Where a point is; kOnTrim: too near to a trimming curve to tell.
  Where where(const Uv& at) const;
  const UvBox& bounds() const { return bounds_; }
  const Handle(Geom_Surface) & surface() const { return surface_; }

 private:
  void collect_trims(const FaceRecord& face);
  void add_trim(const EdgeUse& use);
  void add_gap(const Uv& from, const Uv& to);
  void measure_bends();
  bool clip_bounds(const UvBox& domain);
  bool add_spans();
  int build(const std::vector<std::vector<Cell>>& spans, int at, int i0, int i1, int j0, int j1);
  void finish(Cell& cell, const std::vector<int>& trims) const;
  Cell analytic_cell(const UvBox& uv) const;

  Handle(Geom_Surface) surface_;
  double diagonal_ = 0.0, noise_ = 0.0;
  bool proven_ = true;
  UvBox bounds_;  // of the trims
  double bend_u_ = 0.0, bend_v_ = 0.0;
  std::vector<TrimPiece> trims_;
  std::vector<Cell> cells_;
  size_t first_cells_ = 0, bytes_ = 0;
};

}  // namespace isochor::internal
