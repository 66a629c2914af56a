#include "isochor/volume/element_integrals.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/tolerance.h"
#include "isochor/volume/compensated_sum.h"

namespace isochor::internal {
namespace {

// A sum of many terms: short plain sums, added with compensation. Its error does not grow with the
// number of Gauss points.
class ChunkedSum {
 public:
  static constexpr int kChunk = 16;
  // A plain sum of kChunk terms, two for the compensated sum of those.
  static constexpr double kRoundoffs = kChunk + 2.0;

  void add(double term) {
    chunk_ += term;
    if (++count_ < kChunk) return;
    sum_.add(chunk_);
    chunk_ = 0.0;
    count_ = 0;
  }
  double total() {
    sum_.add(chunk_);
    chunk_ = 0.0;
    count_ = 0;
    return sum_.total();
  }

 private:
  CompensatedSum sum_;
  double chunk_ = 0.0;
  int count_ = 0;
};

// x_u y_v - x_v y_u at Gauss point g; `minus` is -1, or +1 for majorants.
double jacobian(const Grid& x, const Grid& y, size_t g, double minus) {
  return x.du[g] * y.dv[g] + minus * (x.dv[g] * y.du[g]);
}

// Radii of the element's vectors: x and y from the middle, z from `height`.
std::array<double, 3> radii(const ElementFields& fields, const std::vector<Vec3>& vectors,
                            double height) {
  Vec3 low = vectors[static_cast<size_t>(fields.point(0))];
  Vec3 high = low;
  for (size_t k = 1; k < fields.block_size(); ++k) {
    const Vec3& p = vectors[static_cast<size_t>(fields.point(k))];
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return {0.5 * (high.x() - low.x()), 0.5 * (high.y() - low.y()),
          std::max(std::abs(low.z() - height), std::abs(high.z() - height))};
}

double minus_of(const ElementFields& fields) { return fields.sizes() ? 1.0 : -1.0; }

}  // namespace

void evaluate_points(ElementFields& fields, const std::vector<Vec3>& points, double height,
                     VectorGrid& out) {
  const Vec3& reference = points[static_cast<size_t>(fields.point(fields.block_size() / 2))];
  fields.evaluate(points, 0, reference.x(), out[0]);
  fields.evaluate(points, 1, reference.y(), out[1]);
  fields.evaluate(points, 2, height, out[2]);
}

void evaluate_directions(ElementFields& fields, const std::vector<Vec3>& directions,
                         VectorGrid& out) {
  for (int axis = 0; axis < 3; ++axis) {
    fields.evaluate(directions, axis, 0.0, out[static_cast<size_t>(axis)]);
  }
}

double element_value(const ElementFields& fields, const VectorGrid& p) {
  const double minus = minus_of(fields);
  ChunkedSum sum;
  for (size_t g = 0; g < fields.grid_size(); ++g) {
    sum.add(fields.weights()[g] * p[2].value[g] * jacobian(p[0], p[1], g, minus));
  }
  return sum.total();
}

std::array<double, 3> element_line(const ElementFields& fields, const VectorGrid& p,
                                   const VectorGrid& d) {
  const double minus = minus_of(fields);
  std::array<ChunkedSum, 3> sums;
  for (size_t g = 0; g < fields.grid_size(); ++g) {
    const double w = fields.weights()[g];
    const double z = p[2].value[g];
    const double dz = d[2].value[g];
    const double j0 = jacobian(p[0], p[1], g, minus);
    const double j1 = jacobian(d[0], p[1], g, minus) + jacobian(p[0], d[1], g, minus);
    const double j2 = jacobian(d[0], d[1], g, minus);
    sums[0].add(w * (dz * j0 + z * j1));
    sums[1].add(w * (dz * j1 + z * j2));
    sums[2].add(w * (dz * j2));
  }
  return {sums[0].total(), sums[1].total(), sums[2].total()};
}

void gradient_integrands(const ElementFields& fields, const VectorGrid& p, VectorGrid& out) {
  const double minus = minus_of(fields);
  for (Grid& grid : out) grid.resize(fields.grid_size());
  for (size_t g = 0; g < fields.grid_size(); ++g) {
    const double w = fields.weights()[g];
    const double wz = w * p[2].value[g];
    out[0].value[g] = 0.0;
    out[0].du[g] = wz * p[1].dv[g];
    out[0].dv[g] = minus * wz * p[1].du[g];
    out[1].value[g] = 0.0;
    out[1].du[g] = minus * wz * p[0].dv[g];
    out[1].dv[g] = wz * p[0].du[g];
    out[2].value[g] = w * jacobian(p[0], p[1], g, minus);
    out[2].du[g] = 0.0;
    out[2].dv[g] = 0.0;
  }
}

double value_remainder(const ElementFields& fields, const std::vector<Vec3>& points,
                       double height) {
  if (fields.remainder() == 0.0) return 0.0;
  const auto r = radii(fields, points, height);
  return fields.remainder() * r[0] * r[1] * r[2];
}

double change_remainder(const ElementFields& fields, const std::vector<Vec3>& points, double height,
                        const std::vector<Vec3>& directions) {
  if (fields.remainder() == 0.0) return 0.0;
  const auto r = radii(fields, points, height);
  const auto d = radii(fields, directions, 0.0);
  // dz J(x, y) + (z + dz) (J(dx, y) + J(x, dy) + J(dx, dy)).
  return fields.remainder() *
         (d[2] * r[0] * r[1] + (r[2] + d[2]) * (d[0] * r[1] + r[0] * d[1] + d[0] * d[1]));
}

double rounding_factor(const PatchForm& patch) {
  const Roundoffs roundoffs(patch);
  // The three functions, the products of the integrand and its sums over terms, the weights of the
  // rule, and the sum over points.
  const double count = roundoffs.value + 2.0 * roundoffs.slope + 10.0 + 1.0 + roundoffs.tables +
                       ChunkedSum::kRoundoffs;
  // Second-order terms and the rounding of the majorant itself: far below one percent.
  return 1.01 * count * kUnitRoundoff;
}

}  // namespace isochor::internal
