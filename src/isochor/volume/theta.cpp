#include "isochor/volume/theta.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/volume/compensated_sum.h"
#include "isochor/volume/element_fields.h"
#include "isochor/volume/span_polynomials.h"
#include "isochor/volume/span_table.h"

namespace isochor {
using internal::SpanPolynomials;

template <>
BasicThetaTensor<double>::BasicThetaTensor(const KnotVector& knots, bool sizes)
    : degree_(knots.degree()),
      size_(knots.size()),
      band_(static_cast<size_t>(size_) * (2 * degree_ + 1) * (2 * degree_ + 1)) {
  const SpanTable table(knots, exact_gauss_points(degree_));
  const auto width = static_cast<size_t>(2 * degree_ + 1);
  for (int s = 0; s < table.spans(); ++s) {
    for (int a = 0; a <= degree_; ++a) {
      for (int b = 0; b <= degree_; ++b) {
        for (int c = 0; c <= degree_; ++c) {
          const double* slopes = sizes ? table.slope_sizes(s, c) : table.slopes(s, c);
          double sum = 0.0;
          for (int g = 0; g < table.gauss_points(); ++g) {
            // The product of the two values first: then law (1) holds bit by bit.
            const double product = table.values(s, a)[g] * table.values(s, b)[g];
            sum += table.weights(s)[g] * product * slopes[g];
          }
          const auto i = static_cast<size_t>(table.first(s) + a);
          band_[(i * width + static_cast<size_t>(b - a + degree_)) * width +
                static_cast<size_t>(c - a + degree_)] += sum;
        }
      }
    }
  }
}

template <>
BasicThetaTensor<double>::BasicThetaTensor(const KnotVector& knots)
    : BasicThetaTensor(knots, false) {}

// Span by span in t from 0 to 1, whose length cancels: with B_i = sum a_p t^p and so on, the
// product integrates to the sum of a_p b_q c_r r / (p + q + r), over the cube of the span's
// denominator.
template <>
BasicThetaTensor<Rational>::BasicThetaTensor(const KnotVector& knots)
    : degree_(knots.degree()),
      size_(knots.size()),
      band_(static_cast<size_t>(size_) * (2 * degree_ + 1) * (2 * degree_ + 1)) {
  const SpanPolynomials table(knots);
  const int d = degree_;
  const auto width = static_cast<size_t>(2 * d + 1);
  std::vector<Integer> product(static_cast<size_t>(2 * d) + 1);
  for (int s = 0; s < table.spans(); ++s) {
    const Integer cube = table.denominator(s) * table.denominator(s) * table.denominator(s);
    for (int a = 0; a <= d; ++a) {
      for (int b = 0; b <= d; ++b) {
        std::fill(product.begin(), product.end(), Integer(0));
        for (int p = 0; p <= d; ++p) {
          for (int q = 0; q <= d; ++q) {
            product[static_cast<size_t>(p + q)].add_product(table.coefficient(s, a, p),
                                                            table.coefficient(s, b, q));
          }
        }
        for (int c = 0; c <= d; ++c) {
          Rational sum;
          for (int power = 0; power <= 3 * d; ++power) {
            Integer coefficient;
            for (int r = std::max(1, power - 2 * d); r <= std::min(d, power); ++r) {
              coefficient += product[static_cast<size_t>(power - r)] *
                             (table.coefficient(s, c, r) * Integer(r));
            }
            if (power > 0) sum += Rational(coefficient, cube * Integer(power));
          }
          const auto i = static_cast<size_t>(table.first(s) + a);
          band_[(i * width + static_cast<size_t>(b - a + d)) * width +
                static_cast<size_t>(c - a + d)] += sum;
        }
      }
    }
  }
}

namespace {

// The tensor with slopes replaced by their sizes, so that no term is negative.
class ThetaSizes : public ThetaTensor {
 public:
  explicit ThetaSizes(const KnotVector& knots) : ThetaTensor(knots, true) {}
};

// Calls visit(index) for the functions that overlap function i.
template <typename Tensor, typename Visit>
void for_each_neighbour(const Tensor& theta, int i, const Visit& visit) {
  const int first = std::max(0, i - theta.degree());
  const int last = std::min(theta.size() - 1, i + theta.degree());
  for (int j = first; j <= last; ++j) visit(j);
}

// Calls visit(i, j, coefficient) with the double indices i = (iu, iv), j, and the integral of eq. 8
// for x_i y_j z_k: theta^u_{ju ku iu} theta^v_{iv kv jv} - theta^u_{iu ku ju} theta^v_{jv kv iv}.
// With `sizes` the two terms are added.
template <typename Tensor, typename Visit>
void contract_around(const Patch& patch, const Tensor& u, const Tensor& v, int ku, int kv,
                     bool sizes, const Visit& visit) {
  for_each_neighbour(u, ku, [&](int iu) {
    for_each_neighbour(u, ku, [&](int ju) {
      const auto x_slope = u(ju, ku, iu);
      const auto y_slope = sizes ? -u(iu, ku, ju) : u(iu, ku, ju);
      if (x_slope == 0 && y_slope == 0) return;
      for_each_neighbour(v, kv, [&](int iv) {
        for_each_neighbour(v, kv, [&](int jv) {
          const auto c = x_slope * v(iv, kv, jv) - y_slope * v(jv, kv, iv);
          visit(patch.point(iu, iv), patch.point(ju, jv), c);
        });
      });
    });
  });
}

// Calls start(patch, k) for every use of a point, and then visit(i, j, k, coefficient) for the
// terms with z_k.
template <typename Tensor, typename Start, typename Visit>
void for_each_term(const PatchModel& model, const std::vector<Vec3>& points, bool sizes,
                   const Start& start, const Visit& visit) {
  ISOCHOR_REQUIRE(points.size() == model.points.size(), points.size(), model.points.size());
  for (const Patch& patch : model.patches) {
    internal::require_poles(patch, points.size());
    ISOCHOR_REQUIRE(patch.weights.empty(), patch.handle);
    const Tensor u(patch.u_knots);
    const Tensor v(patch.v_knots);
    for (int ku = 0; ku < patch.u_size(); ++ku) {
      for (int kv = 0; kv < patch.v_size(); ++kv) {
        const int k = patch.point(ku, kv);
        start(patch, k);
        contract_around(patch, u, v, ku, kv, sizes, [&](int i, int j, const auto& c) {
          visit(static_cast<size_t>(i), static_cast<size_t>(j), static_cast<size_t>(k),
                patch.reversed && !sizes ? -c : c);
        });
      }
    }
  }
}

// The sums over i and j for one z_k are plain; those over k are compensated.
template <typename Tensor, typename Term>
double sum_of_terms(const PatchModel& model, const std::vector<Vec3>& points, bool sizes,
                    const Term& term) {
  internal::CompensatedSum sum;
  double part = 0.0;
  for_each_term<Tensor>(
      model, points, sizes,
      [&](const Patch&, int) {
        sum.add(part);
        part = 0.0;
      },
      [&](size_t i, size_t j, size_t k, double c) { part += term(c, i, j, k); });
  sum.add(part);
  return sum.total();
}

// |computed - exact| <= this times the same sum over sizes.
double rounding_factor(const PatchModel& model) {
  double worst = 0.0;
  for (const Patch& patch : model.patches) {
    double each = 0.0, terms = 1.0;
    for (const KnotVector* knots : {&patch.u_knots, &patch.v_knots}) {
      const int d = knots->degree();
      // A tensor entry: three tabulated numbers and a weight, four products, and the sums over the
      // points of d + 1 spans.
      each += 4.0 * table_roundoffs(d) + 4.0 + (d + 1.0) * exact_gauss_points(d);
      terms *= (2.0 * d + 1.0) * (2.0 * d + 1.0);
    }
    worst = std::max(worst, each + 5.0 + terms);
  }
  return 1.01 * kUnitRoundoff * worst;
}

}  // namespace

double theta_volume(const PatchModel& model, const std::vector<Vec3>& points) {
  return sum_of_terms<ThetaTensor>(model, points, false,
                                   [&](double c, size_t i, size_t j, size_t k) {
                                     return c * points[i].x() * points[j].y() * points[k].z();
                                   });
}

Bounded theta_bounded_volume(const PatchModel& model, const std::vector<Vec3>& points) {
  const double value = theta_volume(model, points);
  const double sizes =
      sum_of_terms<ThetaSizes>(model, points, true, [&](double c, size_t i, size_t j, size_t k) {
        return c * std::abs(points[i].x() * points[j].y() * points[k].z());
      });
  return {value, rounding_factor(model) * sizes + 2.0 * kUnitRoundoff * std::abs(value)};
}

Rational exact_theta_volume(const PatchModel& model, const std::vector<Vec3>& points) {
  Rational sum;
  for_each_term<ExactThetaTensor>(
      model, points, false, [](const Patch&, int) {},
      [&](size_t i, size_t j, size_t k, const Rational& c) {
        sum += c * Rational(points[i].x()) * Rational(points[j].y()) * Rational(points[k].z());
      });
  return sum;
}

std::vector<Vec3> theta_gradient(const PatchModel& model, const std::vector<Vec3>& points) {
  std::vector<Vec3> rows(points.size(), Vec3::Zero());
  for_each_term<ThetaTensor>(
      model, points, false, [](const Patch&, int) {},
      [&](size_t i, size_t j, size_t k, double c) {
        rows[i].x() += c * points[j].y() * points[k].z();
        rows[j].y() += c * points[i].x() * points[k].z();
        rows[k].z() += c * points[i].x() * points[j].y();
      });
  return rows;
}

std::vector<ExactVec3> exact_theta_gradient(const PatchModel& model,
                                            const std::vector<Vec3>& points) {
  std::vector<ExactVec3> rows(points.size());
  for_each_term<ExactThetaTensor>(
      model, points, false, [](const Patch&, int) {},
      [&](size_t i, size_t j, size_t k, const Rational& c) {
        const Rational x(points[i].x()), y(points[j].y()), z(points[k].z());
        rows[i][0] += c * y * z;
        rows[j][1] += c * x * z;
        rows[k][2] += c * x * y;
      });
  return rows;
}

}  // namespace isochor
