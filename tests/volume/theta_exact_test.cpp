// The published tensors against exact integrals of exact polynomials.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "isochor/base/error.h"
#include "isochor/exact/rational.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/span_polynomials.h"
#include "isochor/volume/theta.h"
#include "support/exact_splines.h"
#include "support/messages.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

using internal::SpanPolynomials;
using ::isochor::testing::message_of;
using ::testing::HasSubstr;

using Polynomial = std::vector<Rational>;

Polynomial product(const Polynomial& a, const Polynomial& b) {
  Polynomial result(a.size() + b.size() - 1);
  for (size_t i = 0; i < a.size(); ++i) {
    for (size_t j = 0; j < b.size(); ++j) result[i + j] += a[i] * b[j];
  }
  return result;
}

Polynomial slope_of(const Polynomial& a) {
  Polynomial result(a.size() > 1 ? a.size() - 1 : 1);
  for (size_t k = 1; k < a.size(); ++k) result[k - 1] = Rational(static_cast<int>(k)) * a[k];
  return result;
}

Polynomial function_on(const SpanPolynomials& table, int s, int i) {
  Polynomial result(static_cast<size_t>(table.degree()) + 1);
  const int j = i - table.first(s);
  if (j < 0 || j > table.degree()) return result;
  for (int k = 0; k <= table.degree(); ++k) {
    result[static_cast<size_t>(k)] = Rational(table.coefficient(s, j, k), table.denominator(s));
  }
  return result;
}

// Integral of B_i B_j B_k' over the domain; span lengths cancel.
Rational exact_theta(const SpanPolynomials& table, int i, int j, int k) {
  Rational sum;
  for (int s = 0; s < table.spans(); ++s) {
    const Polynomial integrand =
        product(product(function_on(table, s, i), function_on(table, s, j)),
                slope_of(function_on(table, s, k)));
    for (size_t power = 0; power < integrand.size(); ++power) {
      sum += integrand[power] / Rational(static_cast<int>(power) + 1);
    }
  }
  return sum;
}

TEST(ThetaExact, EveryEntryOfEveryKindOfVector) {
  std::mt19937 random(441);
  for (const KnotVector& knots :
       {testing::random_clamped(random, 1, 3), testing::random_clamped(random, 2, 2),
        testing::random_unclamped(random, 2, 3), testing::random_clamped(random, 3, 1, 3),
        testing::random_wrapped(random, 3, 4), KnotVector(2, {-1, 0, 0, 0, 1, 1, 2, 3, 3})}) {
    const ThetaTensor theta(knots);
    const SpanPolynomials table(knots);
    ASSERT_EQ(theta.size(), knots.size());
    for (int i = 0; i < theta.size(); ++i) {
      for (int j = i; j < theta.size(); ++j) {
        for (int k = 0; k < theta.size(); ++k) {
          const Rational exact = exact_theta(table, i, j, k);
          EXPECT_NEAR(theta(i, j, k), exact.to_double(), 8e-16) << i << ' ' << j << ' ' << k;
          const int d = knots.degree();
          if (j - i > d || std::abs(k - i) > d || std::abs(k - j) > d) {
            EXPECT_EQ(theta(i, j, k), 0.0);
            EXPECT_TRUE(exact.is_zero());
          }
        }
      }
    }
  }
}

TEST(ThetaExact, HighDegrees) {
  for (int degree : {9, 16, kMaxDegree}) {
    const KnotVector knots = KnotVector::uniform(degree, 1);
    const ThetaTensor theta(knots);
    const SpanPolynomials table(knots);
    for (const auto& [i, j, k] :
         {std::array{0, 0, 0}, std::array{0, degree, 1},
          std::array{degree / 2, degree / 3, degree - 1}, std::array{degree, degree, degree}}) {
      EXPECT_NEAR(theta(i, j, k), exact_theta(table, i, j, k).to_double(), 4e-15) << degree;
    }
  }
}

TEST(ThetaExact, VolumesAndGradientsOfSmallModelsAreThoseOfTheRationals) {
  for (const auto& [du, dv] : {std::pair{1, 1}, std::pair{2, 3}, std::pair{4, 2}}) {
    for (const bool unclamped : {false, true}) {
      PatchModel model = testing::random_open_patch(442, du, dv, 2, unclamped);
      model.patches[0].reversed = unclamped;
      const ExactVolume exact(model);
      EXPECT_NEAR(theta_volume(model, model.points), exact.value(model.points).to_double(), 1e-14);
      const auto rows = theta_gradient(model, model.points);
      const auto exact_rows = exact.gradient(model.points);
      for (size_t i = 0; i < rows.size(); ++i) {
        for (size_t axis = 0; axis < 3; ++axis) {
          EXPECT_NEAR(rows[i][static_cast<int>(axis)], exact_rows[i][axis].to_double(), 1e-14);
        }
      }
    }
  }
}

TEST(ThetaExact, RationalTensorsAreTheIntegrals) {
  std::mt19937 random(443);
  for (const KnotVector& knots :
       {testing::random_clamped(random, 1, 2), testing::random_clamped(random, 3, 2, 3),
        testing::random_unclamped(random, 2, 3), KnotVector::uniform(5, 1)}) {
    const ExactThetaTensor theta(knots);
    const SpanPolynomials table(knots);
    for (int i = 0; i < theta.size(); ++i) {
      for (int j = 0; j < theta.size(); ++j) {
        for (int k = 0; k < theta.size(); ++k) {
          EXPECT_EQ(theta(i, j, k), exact_theta(table, i, j, k)) << i << ' ' << j << ' ' << k;
        }
      }
    }
  }
}

// Two exact ways must give the same rational number, not nearly the same.
TEST(ThetaExact, RationalVolumesAndGradientsAreThoseOfTheElements) {
  for (const auto& [du, dv] : {std::pair{1, 1}, std::pair{2, 3}, std::pair{3, 1}}) {
    PatchModel model = testing::random_open_patch(444, du, dv, 2, dv == 3);
    model.patches[0].reversed = du == 2;
    const ExactVolume exact(model);
    EXPECT_EQ(exact_theta_volume(model, model.points), exact.value(model.points));
    EXPECT_EQ(exact_theta_gradient(model, model.points), exact.gradient(model.points));
  }
  const PatchModel cube = testing::make_cube_model(2, 2);
  EXPECT_EQ(exact_theta_volume(cube, cube.points), Rational(1));
}

TEST(ThetaExact, Bound) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    PatchModel model = testing::random_open_patch(445 + seed, 1 + static_cast<int>(seed % 4),
                                                  1 + static_cast<int>(seed % 3), 2, seed % 2 == 1);
    for (Vec3& p : model.points) p *= std::pow(10.0, static_cast<double>(seed % 7) - 3.0);
    const Bounded computed = theta_bounded_volume(model, model.points);
    EXPECT_EQ(computed.value, theta_volume(model, model.points));
    const Rational error =
        (Rational(computed.value) - ExactVolume(model).value(model.points)).abs();
    EXPECT_LE(error, Rational(computed.bound)) << seed;
  }
}

TEST(ThetaExact, PointsOtherThanTheModelsOwnAreTaken) {
  const PatchModel model = testing::make_cube_model(2, 2);
  auto doubled = model.points;
  for (Vec3& p : doubled) p *= 2.0;
  EXPECT_NEAR(theta_volume(model, doubled), 8.0, 1e-13);
  EXPECT_NEAR(theta_volume(model, model.points), 1.0, 1e-14);
}

TEST(ThetaExact, PatchesWithWeightsAreNamed) {
  PatchModel model = testing::make_cube_model(1, 1);
  model.patches[3].weights = {1, 1, 2, 1};
  const std::string text = message_of<PreconditionError>(
      [&] { static_cast<void>(theta_gradient(model, model.points)); });
  EXPECT_THAT(text, HasSubstr("weights.empty()"));
  EXPECT_THAT(text, HasSubstr("face:4"));
}

}  // namespace
}  // namespace isochor
