#include "isochor/bspline/surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "isochor/base/error.h"
#include "isochor/bspline/refinement.h"
#include "support/exact_splines.h"
#include "support/messages.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::exact_basis;
using ::isochor::testing::message_of;
using ::isochor::testing::random_clamped;
using ::isochor::testing::random_surface;
using ::isochor::testing::random_unclamped;
using ::testing::HasSubstr;

// All six vectors of one parameter pair, in exact arithmetic: derivatives[k][l][axis] of order k in
// u and l in v, by Leibniz's rule on numerator = weight * S.
class ExactDerivatives {
 public:
  ExactDerivatives(const Surface& surface, double u, double v) {
    const int su = surface.u_knots().span_of(u);
    const int sv = surface.v_knots().span_of(v);
    for (int k = 0; k <= 2; ++k) {
      for (int l = 0; k + l <= 2; ++l) add(surface, su, sv, Rational(u), Rational(v), k, l);
    }
    for (int k = 0; k <= 2; ++k) {
      for (int l = 0; k + l <= 2; ++l) solve(k, l);
    }
  }
  Vec3 operator()(int k, int l) const {
    const auto& at = derivative_[k][l];
    return {at[0].to_double(), at[1].to_double(), at[2].to_double()};
  }

 private:
  void add(const Surface& surface, int su, int sv, const Rational& u, const Rational& v, int k,
           int l) {
    const auto bu = exact_basis(surface.u_knots(), su, u, k);
    const auto bv = exact_basis(surface.v_knots(), sv, v, l);
    for (size_t i = 0; i < bu.size(); ++i) {
      for (size_t j = 0; j < bv.size(); ++j) {
        const size_t at = surface.index(su - surface.u_knots().degree() + static_cast<int>(i),
                                        sv - surface.v_knots().degree() + static_cast<int>(j));
        const Rational share =
            bu[i] * bv[j] * Rational(surface.rational() ? surface.weights()[at] : 1.0);
        weight_[k][l] += share;
        for (int axis = 0; axis < 3; ++axis) {
          numerator_[k][l][axis] += share * Rational(surface.poles()[at][axis]);
        }
      }
    }
  }
  void solve(int k, int l) {
    const auto choose = [](int n, int r) { return Rational(n == 2 && r == 1 ? 2 : 1); };
    for (int axis = 0; axis < 3; ++axis) {
      Rational rest = numerator_[k][l][axis];
      for (int a = 0; a <= k; ++a) {
        for (int b = 0; b <= l; ++b) {
          if (a == 0 && b == 0) continue;
          rest -= choose(k, a) * choose(l, b) * weight_[a][b] * derivative_[k - a][l - b][axis];
        }
      }
      derivative_[k][l][axis] = rest / weight_[0][0];
    }
  }

  Rational weight_[3][3];
  Rational numerator_[3][3][3];
  Rational derivative_[3][3][3];
};

double largest(const Surface& surface) {
  double size = 0.0;
  for (const Vec3& p : surface.poles()) size = std::max(size, p.norm());
  return size;
}

TEST(Surface, DerivativesAgreeWithExactArithmetic) {
  std::mt19937 random(311);
  for (const bool rational : {false, true}) {
    for (int round = 0; round < 6; ++round) {
      const int degree = 1 + round;
      const Surface surface = random_surface(random, random_clamped(random, degree, 2),
                                             random_unclamped(random, 7 - degree, 2), rational);
      for (int sample = 0; sample < 3; ++sample) {
        const double u =
            testing::uniform(random, surface.u_knots().begin(), surface.u_knots().end());
        const double v =
            testing::uniform(random, surface.v_knots().begin(), surface.v_knots().end());
        const ExactDerivatives exact(surface, u, v);
        const SurfaceDerivatives got = surface.derivatives(u, v, 2);
        // Spans are at least 0.1 long: one derivative multiplies sizes by at most 2 * 10 * degree.
        const double bound = 1e-14 * largest(surface);
        EXPECT_LT((got.s - exact(0, 0)).norm(), bound);
        EXPECT_LT((got.su - exact(1, 0)).norm(), 20 * 6 * bound);
        EXPECT_LT((got.sv - exact(0, 1)).norm(), 20 * 6 * bound);
        EXPECT_LT((got.suu - exact(2, 0)).norm(), 400 * 36 * bound);
        EXPECT_LT((got.suv - exact(1, 1)).norm(), 400 * 36 * bound);
        EXPECT_LT((got.svv - exact(0, 2)).norm(), 400 * 36 * bound);
        // Lower orders are the same numbers.
        const SurfaceDerivatives first = surface.derivatives(u, v, 1);
        EXPECT_EQ(first.su, got.su);
        EXPECT_EQ(first.suu, Vec3::Zero());
        EXPECT_EQ(surface.point(u, v), got.s);
        EXPECT_EQ(surface.derivatives(u, v, 0).su, Vec3::Zero());
      }
    }
  }
}

TEST(Surface, CommonFactorsOfTheWeightsDoNotMatter) {
  std::mt19937 random(312);
  const Surface surface =
      random_surface(random, random_clamped(random, 3, 2), random_clamped(random, 2, 3), true);
  for (double factor : {0x1p40, 0x1p-600, 3.7}) {
    std::vector<double> weights = surface.weights();
    for (double& w : weights) w *= factor;
    const Surface scaled(surface.u_knots(), surface.v_knots(), surface.poles(), weights);
    for (double share : {0.0, 0.2, 0.9, 1.0}) {
      const double u = share * surface.u_knots().end();
      const double v = (1.0 - share) * surface.v_knots().end();
      const SurfaceDerivatives a = surface.derivatives(u, v, 2);
      const SurfaceDerivatives b = scaled.derivatives(u, v, 2);
      if (factor == 3.7) {
        EXPECT_LT((a.suv - b.suv).norm(), 1e-12 * (1.0 + a.suv.norm()));
      } else {
        EXPECT_EQ(a.s, b.s);
        EXPECT_EQ(a.suv, b.suv) << "powers of two change no bit";
      }
    }
  }
  // Weights that are all one: the polynomial surface, through the quotient.
  const Surface plain(surface.u_knots(), surface.v_knots(), surface.poles());
  const Surface ones(surface.u_knots(), surface.v_knots(), surface.poles(),
                     std::vector<double>(surface.poles().size(), 1.0));
  EXPECT_LT((plain.point(0.3, 0.4) - ones.point(0.3, 0.4)).norm(), 1e-15);
  EXPECT_LT((plain.derivatives(0.3, 0.4, 2).suu - ones.derivatives(0.3, 0.4, 2).suu).norm(), 1e-11);
}

TEST(Surface, LimitsAtKnotsAreThoseOfTheSpans) {
  // A roof in u, a step of slope in v: all four quadrants of derivatives differ.
  const KnotVector u(2, {0, 0, 0, 1, 1, 2, 2, 2});
  const KnotVector v = KnotVector::clamped(1, {0, 1, 3});
  std::mt19937 random(313);
  const Surface surface = random_surface(random, u, v, true);
  constexpr double kStep = 1e-7;
  for (const Limit in_u : {Limit::kFromAbove, Limit::kFromBelow}) {
    for (const Limit in_v : {Limit::kFromAbove, Limit::kFromBelow}) {
      const double du = in_u == Limit::kFromAbove ? kStep : -kStep;
      const double dv = in_v == Limit::kFromAbove ? kStep : -kStep;
      const SurfaceDerivatives limit = surface.derivatives(1, 1, 2, in_u, in_v);
      const SurfaceDerivatives near = surface.derivatives(1 + du, 1 + dv, 2);
      EXPECT_LT((limit.s - near.s).norm(), 1e-5);
      EXPECT_LT((limit.su - near.su).norm(), 1e-4);
      EXPECT_LT((limit.sv - near.sv).norm(), 1e-4);
      EXPECT_LT((limit.suu - near.suu).norm(), 1e-3);
    }
  }
  const auto above = surface.derivatives(1, 0.5, 1, Limit::kFromAbove).su;
  const auto below = surface.derivatives(1, 0.5, 1, Limit::kFromBelow).su;
  EXPECT_GT((above - below).norm(), 0.1);
  // At the ends of the domain there is one limit only.
  EXPECT_EQ(surface.derivatives(0, 0, 1, Limit::kFromBelow, Limit::kFromBelow).su,
            surface.derivatives(0, 0, 1).su);
  EXPECT_EQ(surface.derivatives(2, 3, 1, Limit::kFromBelow, Limit::kFromBelow).sv,
            surface.derivatives(2, 3, 1).sv);
}

TEST(Surface, FollowsAffineMapsAndSwappedDirections) {
  std::mt19937 random(314);
  const Surface surface =
      random_surface(random, random_clamped(random, 3, 3), random_unclamped(random, 2), true);
  Eigen::Matrix3d matrix;
  matrix << 0.5, -1.25, 0.25, 2.0, 0.75, -0.5, 0.125, 1.0, 1.5;
  const Vec3 shift(4, -2, 8);
  std::vector<Vec3> mapped = surface.poles();
  for (Vec3& p : mapped) p = matrix * p + shift;
  const Surface image(surface.u_knots(), surface.v_knots(), mapped, surface.weights());
  std::vector<Vec3> poles;
  std::vector<double> weights;
  for (int j = 0; j < surface.v_size(); ++j) {
    for (int i = 0; i < surface.u_size(); ++i) {
      poles.push_back(surface.pole(i, j));
      weights.push_back(surface.weights()[surface.index(i, j)]);
    }
  }
  const Surface swapped(surface.v_knots(), surface.u_knots(), poles, weights);
  for (double u : testing::sample_parameters(surface.u_knots(), 2)) {
    for (double v : testing::sample_parameters(surface.v_knots(), 1)) {
      const SurfaceDerivatives a = surface.derivatives(u, v, 2);
      const SurfaceDerivatives b = image.derivatives(u, v, 2);
      EXPECT_LT((b.s - matrix * a.s - shift).norm(), 1e-13);
      EXPECT_LT((b.suv - matrix * a.suv).norm(), 1e-12 * (1.0 + a.suv.norm()));
      const SurfaceDerivatives c = swapped.derivatives(v, u, 2);
      EXPECT_LT((a.s - c.s).norm(), 1e-14);
      EXPECT_LT((a.su - c.sv).norm(), 1e-12 * (1.0 + a.su.norm()));
      EXPECT_LT((a.svv - c.suu).norm(), 1e-11 * (1.0 + a.svv.norm()));
      EXPECT_LT((surface.normal(u, v) + swapped.normal(v, u)).norm(), 1e-8);
    }
  }
}

TEST(Surface, NormalIsOfUnitLengthOrZero) {
  const PatchModel sphere = testing::make_sphere(3.0);
  const Surface surface = sphere.surface(0);
  for (double u : {0.3, 1.9}) {
    const Vec3 n = surface.normal(u, 1.1);
    EXPECT_NEAR(n.norm(), 1.0, 1e-15);
    EXPECT_LT(n.cross(surface.point(u, 1.1)).norm(), 1e-14);
  }
  const KnotVector line = KnotVector::uniform(1, 1);
  const Surface collapsed(line, line, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
  EXPECT_EQ(collapsed.normal(0.5, 0.5), Vec3::Zero());
}

TEST(Surface, SidesHaveNamesAndDirections) {
  EXPECT_STREQ(name_of(Side::kUBegin), "u0");
  EXPECT_STREQ(name_of(Side::kUEnd), "u1");
  EXPECT_STREQ(name_of(Side::kVBegin), "v0");
  EXPECT_STREQ(name_of(Side::kVEnd), "v1");
  for (Side side : kSides) {
    EXPECT_EQ(is_u_side(side), name_of(side)[0] == 'u');
    EXPECT_EQ(is_begin_side(side), name_of(side)[1] == '0');
  }
}

TEST(Surface, RefusesSizesAndWeightsThatDoNotFit) {
  const KnotVector line = KnotVector::uniform(1, 1);
  const std::vector<Vec3> four(4, Vec3::Zero());
  const auto message = [&](const std::vector<Vec3>& poles, const std::vector<double>& weights) {
    return message_of<PreconditionError>([&] { Surface(line, line, poles, weights); });
  };
  EXPECT_EQ(message(four, {}), "no error");
  EXPECT_THAT(message(std::vector<Vec3>(3), {}), HasSubstr("poles_.size() == expected"));
  EXPECT_THAT(message(four, {1, 1, 1}), HasSubstr("weights_.size() == expected"));
  EXPECT_THAT(message(four, {1, 1, -0.5, 1}), HasSubstr("-0.5"));
  EXPECT_THAT(message(four, {1, 1, 0, 1}), HasSubstr("w > 0.0"));
  EXPECT_THAT(message(four, {1, 1, std::nan(""), 1}), HasSubstr("nan"));
  EXPECT_THAT(message(four, {1, INFINITY, 1, 1}), HasSubstr("inf"));
  const Surface surface(line, line, four);
  EXPECT_THROW(static_cast<void>(surface.derivatives(0, 0, 3)), PreconditionError);
  EXPECT_THROW(static_cast<void>(surface.derivatives(0, 0, -1)), PreconditionError);
}

}  // namespace
}  // namespace isochor
