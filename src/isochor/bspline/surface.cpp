#include "isochor/bspline/surface.h"

#include <cmath>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/bspline/surface_derivatives.h"

namespace isochor {
namespace {

// The span to use for a one-sided limit: at a knot, kFromBelow takes the span that ends there.
int span_for(const KnotVector& knots, double t, Limit limit) {
  int span = knots.span_of(t);
  if (limit == Limit::kFromBelow && t == knots[span]) {
    for (int candidate : knots.spans()) {
      if (candidate < span && knots[candidate + 1] == t) return candidate;
    }
  }
  return span;
}

}  // namespace

const char* name_of(Side side) {
  switch (side) {
    case Side::kUBegin:
      return "u0";
    case Side::kUEnd:
      return "u1";
    case Side::kVBegin:
      return "v0";
    case Side::kVEnd:
      return "v1";
  }
  return "?";
}

Surface::Surface(KnotVector u_knots, KnotVector v_knots, std::vector<Vec3> poles,
                 std::vector<double> weights)
    : u_knots_(std::move(u_knots)),
      v_knots_(std::move(v_knots)),
      poles_(std::move(poles)),
      weights_(std::move(weights)) {
  const auto expected = static_cast<size_t>(u_size()) * static_cast<size_t>(v_size());
  ISOCHOR_REQUIRE(poles_.size() == expected, poles_.size(), u_size(), v_size());
  ISOCHOR_REQUIRE(weights_.empty() || weights_.size() == expected, weights_.size());
  for (double w : weights_) ISOCHOR_REQUIRE(w > 0.0 && std::isfinite(w), w);
}

Vec3 Surface::point(double u, double v) const { return derivatives(u, v, 0).s; }

SurfaceDerivatives Surface::derivatives(double u, double v, int order, Limit u_limit,
                                        Limit v_limit) const {
  ISOCHOR_REQUIRE(0 <= order && order <= 2, order);
  return internal::derivatives_from(*this, internal::basis_at(u_knots_, u, order, u_limit),
                                    internal::basis_at(v_knots_, v, order, v_limit), order);
}

BasisValues internal::basis_at(const KnotVector& knots, double t, int order, Limit limit) {
  return evaluate_basis_on_span(knots, span_for(knots, t, limit), t, order);
}

SurfaceDerivatives internal::derivatives_from(const Surface& surface, const BasisValues& bu,
                                              const BasisValues& bv, int order) {
  const std::vector<Vec3>& poles = surface.poles();
  const std::vector<double>& weights = surface.weights();
  const bool rational = surface.rational();
  // Derivatives of the weighted numerator a and the denominator w, indexed [k][l] for d^k_u d^l_v.
  Vec3 a[3][3];
  double w[3][3];
  for (int l = 0; l <= order; ++l) {
    for (int k = 0; k + l <= order; ++k) {
      a[k][l].setZero();
      w[k][l] = 0.0;
    }
    for (int i = 0; i <= bu.degree; ++i) {
      Vec3 row = Vec3::Zero();
      const size_t first = surface.index(bu.first + i, bv.first);
      for (int j = 0; j <= bv.degree; ++j) {
        const size_t at = first + static_cast<size_t>(j);
        row += (rational ? bv.value(l, j) * weights[at] : bv.value(l, j)) * poles[at];
      }
      for (int k = 0; k + l <= order; ++k) a[k][l] += bu.value(k, i) * row;
      if (!rational) continue;
      double weight_row = 0.0;
      for (int j = 0; j <= bv.degree; ++j) {
        weight_row += bv.value(l, j) * weights[first + static_cast<size_t>(j)];
      }
      for (int k = 0; k + l <= order; ++k) w[k][l] += bu.value(k, i) * weight_row;
    }
  }

  SurfaceDerivatives out;
  if (!rational) {
    out.s = a[0][0];
    if (order >= 1) out.su = a[1][0], out.sv = a[0][1];
    if (order >= 2) out.suu = a[2][0], out.suv = a[1][1], out.svv = a[0][2];
    return out;
  }
  // Quotient rule on a = w S.
  const double inverse = 1.0 / w[0][0];
  out.s = a[0][0] * inverse;
  if (order >= 1) {
    out.su = (a[1][0] - w[1][0] * out.s) * inverse;
    out.sv = (a[0][1] - w[0][1] * out.s) * inverse;
  }
  if (order >= 2) {
    out.suu = (a[2][0] - 2.0 * w[1][0] * out.su - w[2][0] * out.s) * inverse;
    out.suv = (a[1][1] - w[1][0] * out.sv - w[0][1] * out.su - w[1][1] * out.s) * inverse;
    out.svv = (a[0][2] - 2.0 * w[0][1] * out.sv - w[0][2] * out.s) * inverse;
  }
  return out;
}

Vec3 Surface::normal(double u, double v) const {
  const SurfaceDerivatives at = derivatives(u, v, 1);
  const Vec3 cross = at.su.cross(at.sv);
  const double length = cross.norm();
  return length > 0.0 ? Vec3(cross / length) : Vec3(Vec3::Zero());
}

}  // namespace isochor
