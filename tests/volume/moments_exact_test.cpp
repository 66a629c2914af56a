// Moment integrals against exact rational numbers, got from another field of Gauss's theorem:
// integral of x^a y^b z^c over B = surface integral of x^a y^b z^(c+1) / (c+1) dx dy.
#include <gtest/gtest.h>

#include <cmath>

#include "isochor/exact/rational.h"
#include "isochor/volume/moments.h"
#include "isochor/volume/span_polynomials.h"
#include "support/models.h"

namespace isochor {
namespace {

using internal::SpanPolynomials;

// A polynomial in (s, t), coefficient of s^i t^j at i * columns + j.
struct Polynomial {
  size_t rows = 1, columns = 1;
  std::vector<Rational> at{Rational(1)};

  Polynomial() = default;
  Polynomial(size_t m, size_t n) : rows(m), columns(n), at(m * n) {}

  friend Polynomial operator*(const Polynomial& a, const Polynomial& b) {
    Polynomial c(a.rows + b.rows - 1, a.columns + b.columns - 1);
    for (size_t i = 0; i < a.rows; ++i) {
      for (size_t j = 0; j < a.columns; ++j) {
        const Rational& left = a.at[i * a.columns + j];
        if (left.is_zero()) continue;
        for (size_t k = 0; k < b.rows; ++k) {
          for (size_t l = 0; l < b.columns; ++l) {
            c.at[(i + k) * c.columns + j + l] += left * b.at[k * b.columns + l];
          }
        }
      }
    }
    return c;
  }
  friend Polynomial operator-(Polynomial a, const Polynomial& b) {
    for (size_t k = 0; k < a.at.size(); ++k) a.at[k] -= b.at[k];
    return a;
  }
  // Same shape, so that Jacobians can be subtracted.
  Polynomial derivative(bool along_rows) const {
    Polynomial d(rows, columns);
    for (size_t i = along_rows ? 1 : 0; i < rows; ++i) {
      for (size_t j = along_rows ? 0 : 1; j < columns; ++j) {
        const size_t to = along_rows ? (i - 1) * columns + j : i * columns + j - 1;
        d.at[to] = Rational(static_cast<long>(along_rows ? i : j)) * at[i * columns + j];
      }
    }
    return d;
  }
  Rational integral() const {
    Rational sum;
    for (size_t i = 0; i < rows; ++i) {
      for (size_t j = 0; j < columns; ++j) {
        sum += at[i * columns + j] / Rational(static_cast<long>((i + 1) * (j + 1)));
      }
    }
    return sum;
  }
};

using Exact = std::array<Rational, kMomentCount>;

Polynomial coordinate(const PatchModel& model, const Patch& patch, const SpanPolynomials& u,
                      const SpanPolynomials& v, int su, int sv, int axis, double origin) {
  const int du = u.degree();
  const int dv = v.degree();
  Polynomial p(static_cast<size_t>(du) + 1, static_cast<size_t>(dv) + 1);
  for (int i = 0; i <= du; ++i) {
    for (int j = 0; j <= dv; ++j) {
      const int id = patch.point(u.first(su) + i, v.first(sv) + j);
      const Rational c = Rational(model.points[static_cast<size_t>(id)][axis]) - Rational(origin);
      for (int k = 0; k <= du; ++k) {
        for (int l = 0; l <= dv; ++l) {
          p.at[static_cast<size_t>(k) * p.columns + static_cast<size_t>(l)] +=
              c * Rational(u.coefficient(su, i, k), u.denominator(su)) *
              Rational(v.coefficient(sv, j, l), v.denominator(sv));
        }
      }
    }
  }
  return p;
}

void add_element(const Polynomial& x, const Polynomial& y, const Polynomial& z,
                 const Rational& sign, Exact& sums) {
  const Polynomial flux =
      z * (x.derivative(true) * y.derivative(false) - x.derivative(false) * y.derivative(true));
  const Polynomial fx = flux * x;
  const Polynomial fy = flux * y;
  const Polynomial fz = flux * z;
  const Rational half = sign / Rational(2);
  sums[0] += sign * flux.integral();
  sums[1] += sign * fx.integral();
  sums[2] += sign * fy.integral();
  sums[3] += half * fz.integral();
  sums[4] += sign * (fx * x).integral();
  sums[5] += sign * (fx * y).integral();
  sums[6] += half * (fx * z).integral();
  sums[7] += sign * (fy * y).integral();
  sums[8] += half * (fy * z).integral();
  sums[9] += sign / Rational(3) * (fz * z).integral();
}

Exact exact_integrals(const PatchModel& model, const Vec3& origin) {
  Exact sums;
  for (const Patch& patch : model.patches) {
    const SpanPolynomials u(patch.u_knots);
    const SpanPolynomials v(patch.v_knots);
    const Rational sign(patch.reversed ? -1 : 1);
    for (int su = 0; su < u.spans(); ++su) {
      for (int sv = 0; sv < v.spans(); ++sv) {
        const auto along = [&](int axis) {
          return coordinate(model, patch, u, v, su, sv, axis, origin[axis]);
        };
        add_element(along(0), along(1), along(2), sign, sums);
      }
    }
  }
  return sums;
}

struct Case {
  int degrees[3];
  int spans;
};

class MomentsExact : public ::testing::TestWithParam<Case> {};

TEST_P(MomentsExact, WithinTheBound) {
  testing::RandomModelOptions options;
  std::copy(std::begin(GetParam().degrees), std::end(GetParam().degrees), options.degrees);
  options.spans = GetParam().spans;
  PatchModel model = testing::random_closed_model(511, options);
  testing::translate(model, Vec3(10, 0.5, -3));
  const MomentForm form(model);
  for (const Vec3& origin : {Vec3(10.5, 1, -2.5), Vec3(0, 0, 0)}) {
    const MomentIntegrals computed = form.integrals(model.points, origin);
    const Exact exact = exact_integrals(model, origin);
    for (size_t k = 0; k < kMomentCount; ++k) {
      const double error = (Rational(computed.value[k]) - exact[k]).abs().to_double();
      EXPECT_LE(error, computed.bound[k]) << k;
      EXPECT_LT(error, 0.1 * computed.bound[k]) << k << ": rounding errors average out";
      // About an origin near the body the numbers are of order one.
      EXPECT_LT(computed.bound[k], origin.x() > 0 ? 1e-12 : 1e-8) << k;
    }
  }
}

TEST_P(MomentsExact, CentroidAndTensors) {
  testing::RandomModelOptions options;
  std::copy(std::begin(GetParam().degrees), std::end(GetParam().degrees), options.degrees);
  options.spans = GetParam().spans;
  const PatchModel model = testing::random_closed_model(512, options);
  const Exact m = exact_integrals(model, Vec3::Zero());
  const Moments computed = MomentForm(model).moments(model.points);
  constexpr size_t kAt[3][3] = {{4, 5, 6}, {5, 7, 8}, {6, 8, 9}};
  Rational second[3][3];
  for (size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<int>(i);
    const Rational centroid = m[i + 1] / m[0];
    EXPECT_LE((Rational(computed.centroid[row]) - centroid).abs().to_double(),
              computed.centroid_bound[row]);
    EXPECT_NEAR(computed.centroid[row], centroid.to_double(), 1e-15);
    for (size_t j = 0; j < 3; ++j) second[i][j] = m[kAt[i][j]] - m[i + 1] * m[j + 1] / m[0];
  }
  const Rational trace = second[0][0] + second[1][1] + second[2][2];
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      const auto row = static_cast<int>(i);
      const auto column = static_cast<int>(j);
      EXPECT_LE((Rational(computed.second(row, column)) - second[i][j]).abs().to_double(),
                computed.second_bound(row, column));
      const Rational inertia = i == j ? trace - second[i][j] : -second[i][j];
      EXPECT_LE((Rational(computed.inertia(row, column)) - inertia).abs().to_double(),
                computed.inertia_bound(row, column));
      EXPECT_NEAR(computed.inertia(row, column), inertia.to_double(), 1e-15);
      EXPECT_LT(computed.second_bound(row, column), 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Degrees, MomentsExact,
                         ::testing::Values(Case{{1, 1, 1}, 3}, Case{{2, 2, 2}, 2},
                                           Case{{3, 2, 1}, 2}, Case{{3, 3, 3}, 1},
                                           Case{{6, 1, 2}, 1}),
                         [](const auto& tested) {
                           std::string name = "D";
                           for (int d : tested.param.degrees) name += std::to_string(d);
                           return name + "Spans" + std::to_string(tested.param.spans);
                         });

// A polynomial patch under t -> c t / (1 - t + c t) gets weights c^i and keeps its shape.
TEST(MomentsRational, DisguisedPolynomialsKeepTheirMoments) {
  testing::RandomModelOptions options;
  options.spans = 1;
  for (int degree = 1; degree <= 3; ++degree) {
    std::fill(std::begin(options.degrees), std::end(options.degrees), degree);
    PatchModel model = testing::random_closed_model(513, options);
    const Vec3 origin(0.5, 0.25, 0.5);
    // Bezier patches only: one span, clamped.
    const Exact exact = exact_integrals(model, origin);
    for (const double c : {2.0, 16.0}) {
      PatchModel disguised = model;
      for (Patch& patch : disguised.patches) {
        for (int i = 0; i < patch.u_size(); ++i) {
          for (int j = 0; j < patch.v_size(); ++j) {
            patch.weights.push_back(std::pow(c, i) * std::pow(c, -j));
          }
        }
      }
      const MomentForm form(disguised);
      EXPECT_GT(form.gauss_points(0).first, MomentForm(model).gauss_points(0).first);
      const MomentIntegrals computed = form.integrals(model.points, origin);
      for (size_t k = 0; k < kMomentCount; ++k) {
        const double error = (Rational(computed.value[k]) - exact[k]).abs().to_double();
        EXPECT_LE(error, computed.bound[k]) << degree << ' ' << c << ' ' << k;
        EXPECT_LT(computed.bound[k], c < 10 ? 1e-11 : 1e-8);
      }
    }
  }
}

}  // namespace
}  // namespace isochor
