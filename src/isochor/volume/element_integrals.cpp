#include "isochor/volume/element_integrals.h"

#include "isochor/base/tolerance.h"

namespace isochor::internal {
namespace {

// x_u y_v - x_v y_u at Gauss point g; `minus` is -1, or +1 for majorants.
double jacobian(const Grid& x, const Grid& y, size_t g, double minus) {
  return x.du[g] * y.dv[g] + minus * (x.dv[g] * y.du[g]);
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
  double sum = 0.0;
  // Rows first: the error of summation grows with nu + nv, not with their product.
  for (size_t g = 0; g < fields.grid_size();) {
    double row = 0.0;
    for (const size_t end = g + fields.row_length(); g < end; ++g) {
      row += fields.weights()[g] * p[2].value[g] * jacobian(p[0], p[1], g, minus);
    }
    sum += row;
  }
  return sum;
}

std::array<double, 3> element_line(const ElementFields& fields, const VectorGrid& p,
                                   const VectorGrid& d) {
  const double minus = minus_of(fields);
  std::array<double, 3> sum{};
  for (size_t g = 0; g < fields.grid_size();) {
    std::array<double, 3> row{};
    for (const size_t end = g + fields.row_length(); g < end; ++g) {
      const double w = fields.weights()[g];
      const double z = p[2].value[g];
      const double dz = d[2].value[g];
      const double j0 = jacobian(p[0], p[1], g, minus);
      const double j1 = jacobian(d[0], p[1], g, minus) + jacobian(p[0], d[1], g, minus);
      const double j2 = jacobian(d[0], d[1], g, minus);
      row[0] += w * (dz * j0 + z * j1);
      row[1] += w * (dz * j1 + z * j2);
      row[2] += w * (dz * j2);
    }
    for (size_t k = 0; k < 3; ++k) sum[k] += row[k];
  }
  return sum;
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

double rounding_factor(const PatchForm& patch) {
  const int degrees = patch.u->degree() + patch.v->degree();
  const int sums = patch.u->gauss_points() + patch.v->gauss_points();
  // Each of the three factors: tables (9d + 6 per direction, one more for a slope), the shift of
  // the coordinate, the displacement, and d + 2 for the contraction per direction. Then products,
  // weights and sums; quotients double the count.
  const double each = 10.0 * degrees + 20.0;
  const double count = (patch.rational() ? 2.0 : 1.0) * (3.0 * each + 20.0) + sums;
  // Second-order terms and the rounding of the majorant itself: far below one percent.
  return 1.01 * count * kUnitRoundoff;
}

}  // namespace isochor::internal
