// The signed volume enclosed by a model, its gradient and its changes.
//
// Symbols: patch q has the grid of points p = (x, y, z) and sign s_q (-1 when reversed).
//   V(p) = sum_q s_q iint z (x_u y_v - x_v y_u) du dv                     (Sauvage et al., eq. 5,
//   6)
// Points are passed apart from the model, one row per point of the model's table; gradients come
// back the same way: row i is (dV/dx_i, dV/dy_i, dV/dz_i), summed over all patches that use point
// i. An *element* is a rectangle of two non-empty knot spans of one patch.
//
// Patches without weights (or with weights that are all equal) are integrated exactly up to
// rounding: the value and the gradient by VolumeContraction, changes and parts by Gauss quadrature
// per element with ceil(3d/2) points per direction. Patches with other weights get, once, in the
// constructor, cells and points for which the quadrature error is proven to be far below rounding,
// whatever the points are (quadrature_choice.h). All functions below belong to that one functional,
// a cubic in the points, so an edit that keeps it keeps it to rounding whatever the quadrature
// error is.
//
// Far from the origin (|middle height| > height of the model) z is measured from the middle height
// h, and h times the projected area is added as an integral over the rim (see rim.h): nothing is
// lost on closed models, and open models keep the meaning of V.
//
// A model that planes close is measured with a field that has no flux through them
// (flux_field.h): V is then the volume of the closed body as long as its rim stays in the planes.
// All of the above holds in the coordinates of the field's frame; gradients are turned back. Where
// the frame rounds the points (planes that are not coordinate planes through the origin), bounds
// hold an estimate of that to first order.
//
// Laws (each is a test of that name in tests/volume/volume_form_test.cpp):
//  (1) translation:  V(p + t) == V(p)                     (closed models only)
//  (2) linear map:   V(p A^T) == det(A) V(p)              (closed models only)
//  (3) orientation:  reversing every patch negates V
//  (4) linearity:    V is affine in each coordinate column, the others fixed
//  (5) locality:     V(q) - V(p) == value(q, s) - value(p, s) when p and q differ only at the
//                    points of the support s
//  (6) gradient:     V(p + t d) - V(p) == t <gradient(p), d> + O(t^2), on open models too
//  (7) knots:        inserting knots does not change V
//  (8) bound:        |bounded_value - exact volume| <= bound, proven; so for quadrature_value
// Not a law: V >= 0. The sign follows the orientation. Not a law on open models: (1) and (2).
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/volume/bounded.h"
#include "isochor/volume/contraction.h"
#include "isochor/volume/flux_field.h"

namespace isochor {

// One element: the s-th non-empty spans in u and v of a patch.
struct Element {
  int patch = 0;
  int u_span = 0;
  int v_span = 0;
  friend bool operator==(const Element& a, const Element& b) {
    return a.patch == b.patch && a.u_span == b.u_span && a.v_span == b.v_span;
  }
};

// Where a set of points acts. Made by VolumeForm::support_of.
struct Support {
  std::vector<int> points;        // ascending, without repeats
  std::vector<int> row_of;        // per point of the table: its place in `points`, or -1
  std::vector<Element> elements;  // those on which a function of these points lives; in order
};

// V(p + s d) - V(p) = linear s + quadratic s^2 + cubic s^3.
struct LineCubic {
  double linear = 0.0;
  double quadratic = 0.0;
  double cubic = 0.0;
  double change(double s) const { return ((cubic * s + quadratic) * s + linear) * s; }
  double slope(double s) const { return (3.0 * cubic * s + 2.0 * quadratic) * s + linear; }
};

// An immutable functional; copies share their tables. Everything is const and thread-safe.
class VolumeForm {
 public:
  // Uses knots, weights and orientation of the model's patches; its points only to see where
  // the model lies (for h). `threads`: how many the functions of all points may use; no
  // bit depends on it.
  explicit VolumeForm(const PatchModel& model, int threads = 1, const FluxField& field = {});

  // The number of rows that point tables must have.
  int point_count() const;

  // Cost: O(d^2) per point of patches without weights; with weights O(d^3) per element and more.
  double value(const std::vector<Vec3>& points) const;
  ValueAndGradient value_and_gradient(const std::vector<Vec3>& points) const;
  std::vector<Vec3> gradient(const std::vector<Vec3>& points) const;

  // The elements under these points (repeats allowed), in a fixed order.
  Support support_of(const std::vector<int>& moved_points) const;
  // All points and elements.
  Support whole() const;

  // The part of V that depends on the points of the support; only differences have a meaning.
  double value(const std::vector<Vec3>& points, const Support& support) const;
  // One row per support.points: those rows of the full gradient.
  std::vector<Vec3> gradient(const std::vector<Vec3>& points, const Support& support) const;

  // V along the line p + s d; `directions` is a full table that is zero outside support.points.
  // Integrated on the expanded difference: no cancellation between large volumes, so the error of
  // each coefficient is relative to its own terms, however small d is.
  LineCubic line_cubic(const std::vector<Vec3>& points, const std::vector<Vec3>& directions,
                       const Support& support) const;
  // V(after) - V(before) by line_cubic; the tables agree outside support.points.
  double change(const std::vector<Vec3>& before, const std::vector<Vec3>& after,
                const Support& support) const;

  // The same, more precisely, with a proven bound on the distance to the exact volume (change) of
  // these very points. Patches without weights are summed up in twice the precision of double
  // (precise_volume.h): the bound is about half a unit in the last place of the result. With
  // weights: rounding counted step by step, and quadrature. Neighbouring weights beyond 1 : 1e5 may
  // make the bound uselessly large, but not wrong. Cost: some 50 times that of the value.
  Bounded bounded_value(const std::vector<Vec3>& points) const;
  Bounded bounded_change(const std::vector<Vec3>& before, const std::vector<Vec3>& after,
                         const Support& support) const;

  // The value by Gauss quadrature on all patches with its proven bound: a second method.
  Bounded quadrature_value(const std::vector<Vec3>& points) const;

  // Gauss points of the span of a patch that has most of them, (u, v).
  std::pair<int, int> gauss_points(int patch) const;

 private:
  struct Data;
  // The same in the coordinates of the frame.
  VolumeForm local() const;
  // What rounding of the frame's coordinates may do to the value; zero for exact frames.
  double frame_bound(const std::vector<Vec3>& points, const std::vector<int>& moved) const;

  FluxFrame frame_;
  std::shared_ptr<const Data> data_;
};

}  // namespace isochor
