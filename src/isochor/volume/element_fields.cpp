#include "isochor/volume/element_fields.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"

namespace isochor::internal {

void require_poles(const Patch& patch, size_t point_count) {
  const auto expected = static_cast<size_t>(patch.u_size()) * static_cast<size_t>(patch.v_size());
  ISOCHOR_REQUIRE(patch.points.size() == expected, patch.handle, patch.points.size(), expected);
  ISOCHOR_REQUIRE(patch.weights.empty() || patch.weights.size() == expected, patch.handle,
                  patch.weights.size(), expected);
  for (int id : patch.points) {
    ISOCHOR_REQUIRE(0 <= id && static_cast<size_t>(id) < point_count, patch.handle, id,
                    point_count);
  }
}

Roundoffs::Roundoffs(const PatchForm& patch) {
  const int degrees = patch.u->degree() + patch.v->degree();
  tables = table_roundoffs(patch.u->degree()) + table_roundoffs(patch.v->degree());
  // d + 1 for the contraction a direction, one for a difference of coefficients.
  denominator = tables + degrees + 3.0;
  // A shift or a displacement, and the product with the weight.
  coefficient = patch.rational() ? 2.0 : 1.0;
  numerator = denominator + coefficient;
  if (!patch.rational()) {
    value = slope = numerator;
    drift = 1.0;
    return;
  }
  // The quotient: the inverse of W and the product.
  const double division = denominator + 2.0;
  value = numerator + division;
  // (X' - W' x) / W: the terms' own errors, the difference, the division.
  slope = numerator + 1.0 + division;
  drift = (denominator + value + 1.0 + 1.0 + division) / slope;
}

ElementFields::ElementFields(const PatchForm& patch, bool sizes)
    : patch_(&patch),
      kernel_(*patch.u, *patch.v),
      sizes_(sizes),
      grid_index_(kernel_.block_size()),
      roundoffs_(patch),
      transposed_(kernel_.block_size()) {
  block_.value.resize(kernel_.block_size());
}

void ElementFields::place(int su, int sv) {
  su_ = su;
  sv_ = sv;
  const size_t columns = static_cast<size_t>(patch_->v->degree()) + 1;
  for (size_t k = 0; k < grid_index_.size(); ++k) {
    const size_t i = static_cast<size_t>(patch_->u->first(su)) + k / columns;
    const size_t j = static_cast<size_t>(patch_->v->first(sv)) + k % columns;
    grid_index_[k] = i * static_cast<size_t>(patch_->v_size()) + j;
  }
  kernel_.weights(su, sv, quadrature_);
  if (!patch_->rational()) return;
  for (size_t k = 0; k < block_.value.size(); ++k) block_.value[k] = weight(k);
  prepare(0.0);
  kernel_.evaluate(su, sv, block_, denominator_);
}

void ElementFields::evaluate(const std::vector<Vec3>& vectors, int axis, double origin, Grid& out) {
  for (size_t k = 0; k < block_.value.size(); ++k) {
    block_.value[k] = weight(k) * (vectors[static_cast<size_t>(point(k))][axis] - origin);
  }
  prepare(roundoffs_.coefficient);
  kernel_.evaluate(su_, sv_, block_, out);
  if (patch_->rational()) divide(out);
}

void ElementFields::prepare(double roundoffs) {
  kernel_.difference(block_);
  if (!sizes_) return;
  // A difference is as accurate as any number, but for what its two coefficients bring along.
  const double share = roundoffs / roundoffs_.numerator;
  const size_t columns = static_cast<size_t>(patch_->v->degree()) + 1;
  for (double& c : block_.value) c = std::abs(c);
  const auto& size = block_.value;
  for (size_t k = 0; k < block_.u_step.size(); ++k) {
    block_.u_step[k] = std::abs(block_.u_step[k]) + share * (size[k] + size[k + columns]);
  }
  for (size_t k = 0; k < block_.v_step.size(); ++k) {
    const size_t at = k + k / (columns - 1);
    block_.v_step[k] = std::abs(block_.v_step[k]) + share * (size[at] + size[at + 1]);
  }
}

// From the weighted numerator and its derivatives to the quotient's.
void ElementFields::divide(Grid& grid) const {
  const double sense = sizes_ ? -roundoffs_.drift : 1.0;
  for (size_t g = 0; g < grid.value.size(); ++g) {
    const double inverse = 1.0 / denominator_.value[g];
    grid.value[g] *= inverse;
    grid.du[g] = (grid.du[g] - sense * denominator_.du[g] * grid.value[g]) * inverse;
    grid.dv[g] = (grid.dv[g] - sense * denominator_.dv[g] * grid.value[g]) * inverse;
  }
}

const std::vector<double>& ElementFields::project(Grid& a) {
  ISOCHOR_REQUIRE(!sizes_, block_size());
  if (patch_->rational()) {
    for (size_t g = 0; g < a.value.size(); ++g) {
      const double inverse = 1.0 / denominator_.value[g];
      a.du[g] *= inverse;
      a.dv[g] *= inverse;
      const double drift = a.du[g] * denominator_.du[g] + a.dv[g] * denominator_.dv[g];
      a.value[g] = (a.value[g] - drift) * inverse;
    }
  }
  std::fill(transposed_.begin(), transposed_.end(), 0.0);
  kernel_.accumulate(su_, sv_, a, transposed_);
  for (size_t k = 0; k < transposed_.size(); ++k) transposed_[k] *= weight(k);
  return transposed_;
}

}  // namespace isochor::internal
