#include "isochor/volume/moments.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/volume/compensated_sum.h"
#include "isochor/volume/element_fields.h"

namespace isochor {

using internal::CompensatedSum;
using internal::ElementFields;
using internal::Grid;
using internal::PatchForm;
using internal::VectorGrid;

namespace {

// 1 / (k + 3) for a monomial of degree k; divided, so that the exact integers stay exact.
constexpr std::array<double, kMomentCount> kDivisors = {3, 4, 4, 4, 5, 5, 5, 5, 5, 5};
constexpr int kHighestFactors = 5;  // r and its two derivatives in r.N, and two more in xx

constexpr int exact_points(int degree) { return (kHighestFactors * degree + 1) / 2; }

int finer_points(int points) { return std::min(kMaxGaussPoints, points + std::max(2, points / 4)); }

// r and its derivatives on the placed element. Derivatives see positions relative to a point of the
// element, so that they lose nothing however far it is from the origin.
void evaluate(ElementFields& fields, const std::vector<Vec3>& points, const Vec3& origin,
              VectorGrid& out) {
  const Vec3& reference = points[static_cast<size_t>(fields.point(fields.block_size() / 2))];
  for (int axis = 0; axis < 3; ++axis) {
    Grid& grid = out[static_cast<size_t>(axis)];
    fields.evaluate(points, axis, reference[axis], grid);
    const double offset = reference[axis] - origin[axis];
    for (double& value : grid.value) value += fields.sizes() ? std::abs(offset) : offset;
  }
}

Vec3 value_at(const VectorGrid& r, size_t g) {
  return {r[0].value[g], r[1].value[g], r[2].value[g]};
}

// S_u x S_v at a Gauss point; majorants add where it subtracts.
Vec3 normal_at(const VectorGrid& r, size_t g, bool sizes) {
  const double minus = sizes ? 1.0 : -1.0;
  const auto component = [&](size_t a, size_t b) {
    return r[a].du[g] * r[b].dv[g] + minus * (r[a].dv[g] * r[b].du[g]);
  };
  return {component(1, 2), component(2, 0), component(0, 1)};
}

// The ten integrals over one element, without the sign of the patch.
MomentArray element_moments(const ElementFields& fields, const VectorGrid& r) {
  MomentArray sum{};
  // Rows first: the error of summation grows with nu + nv, not with their product.
  for (size_t g = 0; g < fields.grid_size();) {
    MomentArray row{};
    for (const size_t end = g + fields.row_length(); g < end; ++g) {
      const Vec3 at = value_at(r, g);
      const double flux = fields.weights()[g] * at.dot(normal_at(r, g, fields.sizes()));
      const MomentArray f = monomials(at);
      for (size_t k = 0; k < kMomentCount; ++k) row[k] += f[k] * flux;
    }
    for (size_t k = 0; k < kMomentCount; ++k) sum[k] += row[k];
  }
  for (size_t k = 0; k < kMomentCount; ++k) sum[k] /= kDivisors[k];
  return sum;
}

// All elements of a patch, one after the other.
template <typename Visit>
void for_each_element(const PatchForm& patch, bool sizes, const Visit& visit) {
  ElementFields fields(patch, sizes);
  for (int su = 0; su < patch.u->spans(); ++su) {
    for (int sv = 0; sv < patch.v->spans(); ++sv) {
      fields.place(su, sv);
      visit(fields);
    }
  }
}

std::vector<MomentArray> patch_moments(const PatchForm& patch, const std::vector<Vec3>& points,
                                       const Vec3& origin, bool sizes) {
  std::vector<MomentArray> elements;
  VectorGrid r;
  for_each_element(patch, sizes, [&](ElementFields& fields) {
    evaluate(fields, points, origin, r);
    elements.push_back(element_moments(fields, r));
  });
  return elements;
}

// |computed - exact quadrature| <= rounding_factor * majorant for monomial k; docs/volume.md,
// "Moments". Each of the k + 3 factors is a coordinate or a slope: tables 9d + 7 and contraction
// d + 2 per direction, three shifts. Then products, weights, divisions and sums.
double rounding_factor(const PatchForm& patch, size_t k) {
  const double each = 10.0 * (patch.u->degree() + patch.v->degree()) + 22.0;
  const double count = (patch.rational() ? 2.0 : 1.0) * (kDivisors[k] * each + 24.0) +
                       patch.u->gauss_points() + patch.v->gauss_points();
  return 1.01 * count * kUnitRoundoff;
}

// The sum over elements of |a - b|, per monomial.
MomentArray distance(const std::vector<MomentArray>& a, const std::vector<MomentArray>& b) {
  MomentArray sum{};
  for (size_t e = 0; e < a.size(); ++e) {
    for (size_t k = 0; k < kMomentCount; ++k) sum[k] += std::abs(a[e][k] - b[e][k]);
  }
  return sum;
}

PatchForm with_points(const PatchForm& form, int u_points, int v_points) {
  PatchForm result = form;
  result.u = std::make_shared<const SpanTable>(form.u->knots(), u_points);
  result.v = std::make_shared<const SpanTable>(form.v->knots(), v_points);
  return result;
}

PatchForm finer(const PatchForm& form) {
  return with_points(form, finer_points(form.u->gauss_points()),
                     finer_points(form.v->gauss_points()));
}

// The integral of |f r.N| over a patch, by its own rule.
MomentArray absolute_moments(const PatchForm& patch, const std::vector<Vec3>& points,
                             const Vec3& origin) {
  MomentArray sum{};
  VectorGrid r;
  for_each_element(patch, false, [&](ElementFields& fields) {
    evaluate(fields, points, origin, r);
    for (size_t g = 0; g < fields.grid_size(); ++g) {
      const Vec3 at = value_at(r, g);
      const double flux = fields.weights()[g] * std::abs(at.dot(normal_at(r, g, false)));
      const MomentArray f = monomials(at);
      for (size_t k = 0; k < kMomentCount; ++k) sum[k] += std::abs(f[k]) * flux;
    }
  });
  return sum;
}

bool all_within(const MomentArray& change, const MomentArray& size) {
  for (size_t k = 0; k < kMomentCount; ++k) {
    if (change[k] > kQuadratureNoise * size[k]) return false;
  }
  return true;
}

// Raises the rules of a patch with weights, one direction after the other, until two of them agree
// in all integrals but for rounding, and keeps the finer. Seen from `origin`, which is off the
// plane of flat patches: in their own plane they would agree under any rule.
PatchForm with_chosen_rules(PatchForm form, const std::vector<Vec3>& points, const Vec3& origin) {
  const MomentArray size = absolute_moments(form, points, origin);
  std::vector<MomentArray> current = patch_moments(form, points, origin, false);
  for (const bool along_u : {true, false}) {
    for (bool agreed = false; !agreed;) {
      const int nu = form.u->gauss_points();
      const int nv = form.v->gauss_points();
      if ((along_u ? nu : nv) == kMaxGaussPoints) break;
      form = with_points(form, along_u ? finer_points(nu) : nu, along_u ? nv : finer_points(nv));
      auto refined = patch_moments(form, points, origin, false);
      agreed = all_within(distance(current, refined), size);
      current = std::move(refined);
    }
  }
  return form;
}

// Adds the integrals of f(r) phi_i N over one element to row i, for the ten f.
void add_gradient_rows(ElementFields& fields, const VectorGrid& r, double sign,
                       std::array<std::vector<Vec3>, kMomentCount>& rows) {
  const size_t count = fields.grid_size();
  std::vector<MomentArray> factors(count);
  std::vector<Vec3> normals(count);
  for (size_t g = 0; g < count; ++g) {
    factors[g] = monomials(value_at(r, g));
    normals[g] = sign * fields.weights()[g] * normal_at(r, g, false);
  }
  Grid integrand;
  integrand.resize(count);
  for (size_t k = 0; k < kMomentCount; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      for (size_t g = 0; g < count; ++g) {
        integrand.value[g] = factors[g][k] * normals[g][axis];
        integrand.du[g] = integrand.dv[g] = 0.0;
      }
      const std::vector<double>& block = fields.project(integrand);
      for (size_t b = 0; b < fields.block_size(); ++b) {
        rows[k][static_cast<size_t>(fields.point(b))][axis] += block[b];
      }
    }
  }
}

struct Box {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  explicit Box(const std::vector<Vec3>& points) {
    if (points.empty()) return;
    low = high = points.front();
    for (const Vec3& p : points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  Vec3 middle() const { return 0.5 * low + 0.5 * high; }
  // A place off the middle, in a direction that is no plane's own.
  Vec3 aside() const { return middle() + (high - low).norm() * Vec3(0.39, 0.27, 0.31); }
};

}  // namespace

MomentArray monomials(const Vec3& r) {
  return {1.0,           r.x(),         r.y(),         r.z(),         r.x() * r.x(),
          r.x() * r.y(), r.x() * r.z(), r.y() * r.y(), r.y() * r.z(), r.z() * r.z()};
}

struct MomentForm::Data {
  std::vector<PatchForm> patches;
  std::vector<PatchForm> finer;  // of patches with weights: the next finer rules; else empty
  size_t point_count = 0;

  void require_fits(const std::vector<Vec3>& points) const {
    ISOCHOR_REQUIRE(points.size() == point_count, points.size(), point_count);
  }
};

MomentForm::MomentForm(const PatchModel& model) {
  auto data = std::make_shared<Data>();
  data->point_count = model.points.size();
  const Vec3 aside = Box(model.points).aside();
  for (const Patch& patch : model.patches) {
    internal::require_poles(patch, model.points.size());
    PatchForm form;
    form.u = std::make_shared<const SpanTable>(patch.u_knots, exact_points(patch.u_knots.degree()));
    form.v = std::make_shared<const SpanTable>(patch.v_knots, exact_points(patch.v_knots.degree()));
    form.points = patch.points;
    form.sign = patch.sign();
    const auto& w = patch.weights;
    if (std::any_of(w.begin(), w.end(), [&](double each) { return each != w[0]; })) {
      form.weights = w;
      form = with_chosen_rules(std::move(form), model.points, aside);
      data->finer.push_back(finer(form));
    } else {
      data->finer.emplace_back();
    }
    data->patches.push_back(std::move(form));
  }
  data_ = std::move(data);
}

int MomentForm::point_count() const { return static_cast<int>(data_->point_count); }

std::pair<int, int> MomentForm::gauss_points(int patch) const {
  ISOCHOR_REQUIRE(0 <= patch && static_cast<size_t>(patch) < data_->patches.size(), patch);
  const PatchForm& form = data_->patches[static_cast<size_t>(patch)];
  return {form.u->gauss_points(), form.v->gauss_points()};
}

MomentIntegrals MomentForm::integrals(const std::vector<Vec3>& points, const Vec3& origin) const {
  data_->require_fits(points);
  std::array<CompensatedSum, kMomentCount> sums;
  MomentIntegrals result;
  result.origin = origin;
  for (size_t q = 0; q < data_->patches.size(); ++q) {
    const PatchForm& patch = data_->patches[q];
    const auto values = patch_moments(patch, points, origin, false);
    for (const MomentArray& element : values) {
      for (size_t k = 0; k < kMomentCount; ++k) sums[k].add(patch.sign * element[k]);
    }
    for (const MomentArray& element : patch_moments(patch, points, origin, true)) {
      for (size_t k = 0; k < kMomentCount; ++k) {
        result.bound[k] += rounding_factor(patch, k) * element[k];
      }
    }
    const PatchForm& fine = data_->finer[q];
    if (fine.points.empty()) continue;
    // While each finer rule at least halves the error e: e <= |coarse - fine| + e / 2.
    const MomentArray change = distance(values, patch_moments(fine, points, origin, false));
    for (size_t k = 0; k < kMomentCount; ++k) result.bound[k] += 2.0 * change[k];
  }
  for (size_t k = 0; k < kMomentCount; ++k) {
    result.value[k] = sums[k].total();
    result.bound[k] += 3.0 * kUnitRoundoff * std::abs(result.value[k]);
  }
  return result;
}

Moments MomentForm::moments(const std::vector<Vec3>& points) const {
  const Vec3 near = moments_from(integrals(points, Box(points).middle())).centroid;
  return moments_from(integrals(points, near));
}

MomentGradients MomentForm::gradients(const std::vector<Vec3>& points) const {
  const Moments about = moments(points);
  std::array<std::vector<Vec3>, kMomentCount> rows;
  rows.fill(std::vector<Vec3>(points.size(), Vec3::Zero()));
  for (const PatchForm& patch : data_->patches) {
    VectorGrid r;
    for_each_element(patch, false, [&](ElementFields& fields) {
      evaluate(fields, points, about.centroid, r);
      add_gradient_rows(fields, r, patch.sign, rows);
    });
  }
  // About the centroid the first moments vanish, and with them all that its own motion adds.
  MomentGradients result;
  for (size_t k = 0; k < 3; ++k) {
    for (Vec3& row : rows[1 + k]) row /= about.volume.value;
    result.centroid[k] = std::move(rows[1 + k]);
  }
  for (size_t k = 0; k < 6; ++k) result.second[k] = std::move(rows[4 + k]);
  result.volume = std::move(rows[0]);
  return result;
}

}  // namespace isochor
