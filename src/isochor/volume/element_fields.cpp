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

ElementFields::ElementFields(const PatchForm& patch, bool sizes)
    : patch_(&patch),
      kernel_(*patch.u, *patch.v, sizes),
      sizes_(sizes),
      grid_index_(kernel_.block_size()),
      block_(kernel_.block_size()) {}

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
  for (size_t k = 0; k < block_.size(); ++k) block_[k] = weight(k);
  kernel_.evaluate(su, sv, block_, denominator_);
}

void ElementFields::evaluate(const std::vector<Vec3>& vectors, int axis, double origin, Grid& out) {
  for (size_t k = 0; k < block_.size(); ++k) {
    const double c = vectors[static_cast<size_t>(point(k))][axis] - origin;
    block_[k] = weight(k) * (sizes_ ? std::abs(c) : c);
  }
  kernel_.evaluate(su_, sv_, block_, out);
  if (patch_->rational()) divide(out);
}

// From the weighted numerator and its derivatives to the quotient's.
void ElementFields::divide(Grid& grid) const {
  const double sense = sizes_ ? -1.0 : 1.0;
  for (size_t g = 0; g < grid.value.size(); ++g) {
    const double inverse = 1.0 / denominator_.value[g];
    grid.value[g] *= inverse;
    grid.du[g] = (grid.du[g] - sense * denominator_.du[g] * grid.value[g]) * inverse;
    grid.dv[g] = (grid.dv[g] - sense * denominator_.dv[g] * grid.value[g]) * inverse;
  }
}

const std::vector<double>& ElementFields::project(Grid& a) {
  if (patch_->rational()) {
    const double sense = sizes_ ? -1.0 : 1.0;
    for (size_t g = 0; g < a.value.size(); ++g) {
      const double inverse = 1.0 / denominator_.value[g];
      a.du[g] *= inverse;
      a.dv[g] *= inverse;
      const double drift = a.du[g] * denominator_.du[g] + a.dv[g] * denominator_.dv[g];
      a.value[g] = (a.value[g] - sense * drift) * inverse;
    }
  }
  std::fill(block_.begin(), block_.end(), 0.0);
  kernel_.accumulate(su_, sv_, a, block_);
  for (size_t k = 0; k < block_.size(); ++k) block_[k] *= weight(k);
  return block_;
}

}  // namespace isochor::internal
