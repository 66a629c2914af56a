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

ElementKernel::ElementKernel(const SpanTable& u, const SpanTable& v, bool sizes)
    : u_(&u),
      v_(&v),
      sizes_(sizes),
      rows_(static_cast<size_t>(u.degree() + 1) * v.gauss_points()),
      row_slopes_(rows_.size()) {}

void ElementKernel::evaluate(int su, int sv, const std::vector<double>& block, Grid& out) {
  const int nv = v_->gauss_points(sv);
  const int columns = v_->degree() + 1;
  std::fill(rows_.begin(), rows_.end(), 0.0);
  std::fill(row_slopes_.begin(), row_slopes_.end(), 0.0);
  for (int i = 0; i <= u_->degree(); ++i) {
    for (int j = 0; j < columns; ++j) {
      const double c = block[static_cast<size_t>(i) * columns + j];
      add_scaled(nv, c, v_->values(sv, j), &rows_[static_cast<size_t>(i) * nv]);
      add_scaled(nv, c, slopes(*v_, sv, j), &row_slopes_[static_cast<size_t>(i) * nv]);
    }
  }
  out.resize(grid_size(su, sv));
  std::fill(out.value.begin(), out.value.end(), 0.0);
  std::fill(out.du.begin(), out.du.end(), 0.0);
  std::fill(out.dv.begin(), out.dv.end(), 0.0);
  for (int i = 0; i <= u_->degree(); ++i) {
    const double* row = &rows_[static_cast<size_t>(i) * nv];
    const double* row_slope = &row_slopes_[static_cast<size_t>(i) * nv];
    const double* b = u_->values(su, i);
    const double* db = slopes(*u_, su, i);
    for (int g = 0; g < u_->gauss_points(su); ++g) {
      const size_t start = static_cast<size_t>(g) * nv;
      add_scaled(nv, b[g], row, &out.value[start]);
      add_scaled(nv, db[g], row, &out.du[start]);
      add_scaled(nv, b[g], row_slope, &out.dv[start]);
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
    const double* db = slopes(*u_, su, i);
    for (int g = 0; g < u_->gauss_points(su); ++g) {
      const size_t start = static_cast<size_t>(g) * nv;
      add_scaled(nv, b[g], &a.value[start], row);
      add_scaled(nv, db[g], &a.du[start], row);
      add_scaled(nv, b[g], &a.dv[start], row_slope);
    }
    for (int j = 0; j < columns; ++j) {
      block[static_cast<size_t>(i) * columns + j] +=
          dot(nv, v_->values(sv, j), row) + dot(nv, slopes(*v_, sv, j), row_slope);
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
