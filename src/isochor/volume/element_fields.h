// The coordinate functions of one patch, and their gradients, element by element.
//
// On rational patches every function is quotient A / W with A = sum w_ij B_i B_j c_ij; the weights
// are constant, so each function is linear in its coefficients: f = sum R_ij c_ij.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/volume/element_kernel.h"

namespace isochor::internal {

// What the integrals need of a patch.
struct PatchForm {
  std::shared_ptr<const SpanTable> u, v;
  std::vector<int> points;      // #u x #v, indices into the table of points
  std::vector<double> weights;  // the same, or empty
  double sign = 1.0;
  // Per element, u-major: what its quadrature misses, over r_x r_y r_z (see quadrature_choice.h).
  // Empty without weights.
  std::vector<double> remainder = {};

  int v_size() const { return v->knots().size(); }
  bool rational() const { return !weights.empty(); }
};

// Roundings, counted in unit roundoffs (docs/volume.md, "Rounding").
struct Roundoffs {
  explicit Roundoffs(const PatchForm& patch);
  double tables;       // of one table of each direction
  double coefficient;  // of a coefficient, relative to itself
  double denominator;  // of W and its slopes, relative to their majorants
  double numerator;    // of a function and its slopes before the quotient
  double value;        // of a function
  double slope;        // of its slopes
  double drift;        // how many times as much the term W' x of a slope counts
};

// PreconditionError when the patch's points or weights do not fit its knots, or an index is not in
// a table of `point_count` points.
void require_poles(const Patch& patch, size_t point_count);

using VectorGrid = std::array<Grid, 3>;  // one grid for each coordinate

// A workspace for the elements of one patch: `place` it on an element, then evaluate or scatter.
class ElementFields {
 public:
  // `sizes`: majorants instead of functions. |computed - exact| <= Roundoffs::value (slope) * u
  // times those, for functions whose coefficients are one difference away from exact numbers.
  explicit ElementFields(const PatchForm& patch, bool sizes = false);

  void place(int su, int sv);

  size_t grid_size() const { return kernel_.grid_size(su_, sv_); }
  bool sizes() const { return sizes_; }
  size_t row_length() const { return static_cast<size_t>(patch_->v->gauss_points(sv_)); }
  // Quadrature weight at each Gauss point, without the patch's sign.
  const std::vector<double>& weights() const { return quadrature_; }
  // PatchForm::remainder of the placed element; zero without weights.
  double remainder() const {
    if (patch_->remainder.empty()) return 0.0;
    return patch_->remainder[static_cast<size_t>(su_) * static_cast<size_t>(patch_->v->spans()) +
                             static_cast<size_t>(sv_)];
  }
  // Index into the table of points of the block's entry k (k = i (dv + 1) + j).
  int point(size_t k) const { return patch_->points[grid_index_[k]]; }
  size_t block_size() const { return grid_index_.size(); }

  // Coordinate `axis` of the function with coefficients vectors[point] - origin.
  void evaluate(const std::vector<Vec3>& vectors, int axis, double origin, Grid& out);
  // For each block entry k: sum over Gauss points of a.value R_k + a.du dR_k/du + a.dv dR_k/dv.
  // `a` is overwritten. Not for majorants.
  const std::vector<double>& project(Grid& a);

 private:
  double weight(size_t k) const {
    return patch_->rational() ? patch_->weights[grid_index_[k]] : 1.0;
  }
  // From signed_ to block_; `roundoffs`: of each coefficient, for majorants.
  void prepare(double roundoffs);
  void divide(Grid& grid) const;

  const PatchForm* patch_;
  ElementKernel kernel_;
  bool sizes_;
  int su_ = 0, sv_ = 0;
  std::vector<size_t> grid_index_;
  Roundoffs roundoffs_;
  std::vector<double> quadrature_, transposed_;
  Coefficients block_;
  Grid denominator_;
};

}  // namespace isochor::internal
