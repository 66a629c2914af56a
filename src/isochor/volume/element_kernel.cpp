#include "isochor/volume/element_kernel.h"

#include <algorithm>

namespace isochor::internal {
namespace {

// y += a x over `count` numbers.
inline void add_scaled(int count, double a, const double* x, double* y) {
  for (int g = 0; g < count; ++g) y[g] += a * x[g];
}

inline double dot(int count, const double* x, const double* y) {
  double sum = 0.0;
  for (int g = 0; g < count; ++g) sum += x[g] * y[g];
  return sum;
}

}  // namespace

ElementKernel::ElementKernel(const SpanTable& u, const SpanTable& v)
    : u_(&u),
      v_(&v),
      rows_(static_cast<size_t>(u.degree() + 1) * v.gauss_points()),
      row_slopes_(rows_.size()),
      row_steps_(rows_.size()) {}

void ElementKernel::difference(Coefficients& block) const {
  const auto columns = static_cast<size_t>(v_->degree()) + 1;
  block.u_step.resize(block.value.size() - columns);
  for (size_t k = 0; k < block.u_step.size(); ++k) {
    block.u_step[k] = block.value[k + columns] - block.value[k];
  }
  block.v_step.clear();
  for (size_t k = 0; k < block.value.size(); ++k) {
    if ((k + 1) % columns != 0) block.v_step.push_back(block.value[k + 1] - block.value[k]);
  }
}

void ElementKernel::evaluate(int su, int sv, const Coefficients& block, Grid& out) {
  const int nv = v_->gauss_points(sv);
  const int e = v_->degree();
  const int d = u_->degree();
  std::fill(rows_.begin(), rows_.end(), 0.0);
  std::fill(row_slopes_.begin(), row_slopes_.end(), 0.0);
  std::fill(row_steps_.begin(), row_steps_.end(), 0.0);
  for (int i = 0; i <= d; ++i) {
    const size_t row = static_cast<size_t>(i) * nv;
    for (int j = 0; j <= e; ++j) {
      const size_t k = static_cast<size_t>(i) * (e + 1) + j;
      add_scaled(nv, block.value[k], v_->values(sv, j), &rows_[row]);
      if (i < d) add_scaled(nv, block.u_step[k], v_->values(sv, j), &row_steps_[row]);
    }
    for (int j = 0; j < e; ++j) {
      const size_t k = static_cast<size_t>(i) * e + j;
      add_scaled(nv, block.v_step[k], v_->steps(sv, j), &row_slopes_[row]);
    }
  }
  out.resize(grid_size(su, sv));
  std::fill(out.value.begin(), out.value.end(), 0.0);
  std::fill(out.du.begin(), out.du.end(), 0.0);
  std::fill(out.dv.begin(), out.dv.end(), 0.0);
  for (int i = 0; i <= d; ++i) {
    const size_t row = static_cast<size_t>(i) * nv;
    const double* b = u_->values(su, i);
    const double* step = i < d ? u_->steps(su, i) : nullptr;
    for (int g = 0; g < u_->gauss_points(su); ++g) {
      const size_t start = static_cast<size_t>(g) * nv;
      add_scaled(nv, b[g], &rows_[row], &out.value[start]);
      add_scaled(nv, b[g], &row_slopes_[row], &out.dv[start]);
      if (i < d) add_scaled(nv, step[g], &row_steps_[row], &out.du[start]);
    }
  }
}

void ElementKernel::accumulate(int su, int sv, const Grid& a, std::vector<double>& block) {
  const int nv = v_->gauss_points(sv);
  const int columns = v_->degree() + 1;
  std::fill(rows_.begin(), rows_.end(), 0.0);
  std::fill(row_slopes_.begin(), row_slopes_.end(), 0.0);
  for (int i = 0; i <= u_->degree(); ++i) {
    double* row = &rows_[static_cast<size_t>(i) * nv];
    double* row_slope = &row_slopes_[static_cast<size_t>(i) * nv];
    const double* b = u_->values(su, i);
    const double* db = u_->slopes(su, i);
    for (int g = 0; g < u_->gauss_points(su); ++g) {
      const size_t start = static_cast<size_t>(g) * nv;
      add_scaled(nv, b[g], &a.value[start], row);
      add_scaled(nv, db[g], &a.du[start], row);
      add_scaled(nv, b[g], &a.dv[start], row_slope);
    }
    for (int j = 0; j < columns; ++j) {
      block[static_cast<size_t>(i) * columns + j] +=
          dot(nv, v_->values(sv, j), row) + dot(nv, v_->slopes(sv, j), row_slope);
    }
  }
}

void ElementKernel::weights(int su, int sv, std::vector<double>& out) const {
  const int nv = v_->gauss_points(sv);
  out.resize(grid_size(su, sv));
  for (int g = 0; g < u_->gauss_points(su); ++g) {
    for (int h = 0; h < nv; ++h) {
      out[static_cast<size_t>(g) * nv + h] = u_->weights(su)[g] * v_->weights(sv)[h];
    }
  }
}

}  // namespace isochor::internal
