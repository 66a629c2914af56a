// The bound of the Gauss remainder where it is large enough to see: few points, strong weights.
#include "isochor/volume/gauss_remainder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "isochor/base/error.h"
#include "isochor/bspline/surface.h"
#include "isochor/volume/quadrature_choice.h"
#include "isochor/volume/span_table.h"
#include "support/fine_quadrature.h"
#include "support/splines.h"

namespace isochor::internal {
namespace {

std::vector<double> weights_of_ratio(std::mt19937& random, size_t count, double ratio) {
  std::vector<double> weights(count);
  for (double& w : weights) w = std::exp(testing::uniform(random, 0.0, std::log(ratio)));
  return weights;
}

WeightNet bezier_net(const std::vector<double>& weights, int du, int dv) {
  return net_of(KnotVector::uniform(du, 1), KnotVector::uniform(dv, 1), weights, 0, 0);
}

// Poles at the corners of the unit box: the largest numerators that the bound must allow for.
std::vector<Vec3> box_corners(std::mt19937& random, size_t count) {
  std::vector<Vec3> poles(count);
  for (Vec3& p : poles) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = random() % 2 == 0 ? 1.0 : -1.0;
  }
  return poles;
}

// n Gauss points in u, as good as exact in v.
double with_points(const Surface& surface, int n) {
  static const auto across = testing::fine_gauss<double>(40);
  const auto along = testing::fine_gauss<double>(n);
  double sum = 0.0;
  for (const auto& [v, v_weight] : across) {
    for (const auto& [u, u_weight] : along) {
      const SurfaceDerivatives at = surface.derivatives(u, v, 1);
      sum += u_weight * v_weight * at.s.z() * (at.su.x() * at.sv.y() - at.sv.x() * at.su.y());
    }
  }
  return sum;
}

TEST(GaussRemainder, BoundsTheErrorOfEveryRule) {
  std::mt19937 random(501);
  std::vector<double> pessimism;
  for (double ratio : {1.2, 3.0, 10.0}) {
    for (const auto& [du, dv] :
         {std::pair{1, 1}, std::pair{2, 2}, std::pair{3, 2}, std::pair{4, 1}}) {
      for (int round = 0; round < 5; ++round) {
        const auto count = static_cast<size_t>((du + 1) * (dv + 1));
        const auto weights = weights_of_ratio(random, count, ratio);
        const Surface surface(KnotVector::uniform(du, 1), KnotVector::uniform(dv, 1),
                              box_corners(random, count), weights);
        const GaussRemainder remainder(bezier_net(weights, du, dv));
        const double exact = with_points(surface, 60);
        for (int n = 2; n <= 10; ++n) {
          const double error = std::abs(with_points(surface, n) - exact);
          EXPECT_LE(error, remainder.bound(n) + 1e-13) << ratio << ' ' << du << ' ' << n;
          EXPECT_LE(remainder.bound(n + 1), remainder.bound(n));
          if (error > 1e-12) pessimism.push_back(remainder.bound(n) / error);
        }
      }
    }
  }
  ASSERT_GT(pessimism.size(), 200u);
  std::nth_element(pessimism.begin(), pessimism.begin() + pessimism.size() / 2, pessimism.end());
  const double median = pessimism[pessimism.size() / 2];
  RecordProperty("median_pessimism", std::to_string(median));
  // Ten thousand is four points more than a clairvoyant would take.
  EXPECT_LT(median, 1e5);
}

TEST(GaussRemainder, BoundsTheAreaUnderACurve) {
  // The integral of x dy along a rational Bezier curve.
  std::mt19937 random(506);
  for (double ratio : {1.3, 5.0, 20.0}) {
    for (int d = 1; d <= 4; ++d) {
      const auto weights = weights_of_ratio(random, static_cast<size_t>(d) + 1, ratio);
      const auto poles = box_corners(random, weights.size());
      std::vector<double> ribbon_weights;
      std::vector<Vec3> ribbon;
      for (size_t i = 0; i < poles.size(); ++i) {
        for (int side = 0; side < 2; ++side) {
          ribbon.push_back(poles[i]);
          ribbon_weights.push_back(weights[i]);
        }
      }
      const Surface curve(KnotVector::uniform(d, 1), KnotVector::uniform(1, 1), ribbon,
                          ribbon_weights);
      const auto area = [&](int n) {
        double sum = 0.0;
        for (const auto& [u, weight] : testing::fine_gauss<double>(n)) {
          const SurfaceDerivatives at = curve.derivatives(u, 0.5, 1);
          sum += weight * at.s.x() * at.su.y();
        }
        return sum;
      };
      const WeightNet net = net_of(KnotVector::uniform(d, 1), weights, 0);
      ASSERT_EQ(net.columns, 1);
      const GaussRemainder remainder(net, Integrand::kArea);
      for (int n = 2; n <= 10; ++n) {
        const double error = std::abs(area(n) - area(60));
        EXPECT_LE(error, remainder.bound(n) + 1e-13) << ratio << ' ' << d << ' ' << n;
      }
      if (ratio <= 5.0) {
        EXPECT_LT(remainder.bound(40), 1.0);
      }
    }
  }
}

TEST(GaussRemainder, RatesAreThoseOfTheNearestZero) {
  // W = 1 + c t has its zero at t = -1/c, on the ellipse with rho = 1 + 2/c + 2 sqrt(1/c + 1/c^2).
  for (double c : {0.5, 2.0, 8.0}) {
    const GaussRemainder remainder(bezier_net({1, 1, 1 + c, 1 + c}, 1, 1));
    const double rho = 1 + 2 / c + 2 * std::sqrt(1 / c + 1 / (c * c));
    const double rate = std::log(remainder.bound(20) / remainder.bound(30)) / 20;
    EXPECT_LT(rate, std::log(rho));
    EXPECT_GT(rate, 0.75 * std::log(rho)) << c;
  }
}

TEST(GaussRemainder, HoldsOnEveryPartAcross) {
  std::mt19937 random(502);
  for (int round = 0; round < 20; ++round) {
    const WeightNet net = bezier_net(weights_of_ratio(random, 12, 30.0), 2, 3);
    const auto [left, right] = halves(transposed(net));
    for (const WeightNet& part : {transposed(left), transposed(right)}) {
      for (int n : {3, 8, 20}) {
        // Not a law to the last bit: ellipses are sampled.
        EXPECT_LE(GaussRemainder(part).bound(n), 1.5 * GaussRemainder(net).bound(n));
      }
    }
  }
}

TEST(GaussRemainder, CommonFactorsDoNotMatter) {
  std::mt19937 random(503);
  const auto weights = weights_of_ratio(random, 9, 5.0);
  const GaussRemainder plain(bezier_net(weights, 2, 2));
  auto scaled = weights;
  for (double& w : scaled) w *= 0x1p40;
  EXPECT_EQ(GaussRemainder(bezier_net(scaled, 2, 2)).bound(9), plain.bound(9));
  // A factor per column leaves the rate; the columns' own slopes enter as a factor.
  const std::vector<double> one_way = {1, 1, 1, 3, 3, 3, 2, 2, 2};
  auto both = one_way;
  for (size_t k = 0; k < both.size(); ++k) both[k] *= k % 3 == 1 ? 4.0 : 1.0;
  const double factor = GaussRemainder(bezier_net(both, 2, 2)).bound(12) /
                        GaussRemainder(bezier_net(one_way, 2, 2)).bound(12);
  EXPECT_GT(factor, 1.0);
  EXPECT_LT(factor, 100.0);
}

TEST(GaussRemainder, PolynomialDirectionsAreExactFromTheExactRuleOn) {
  const WeightNet across = bezier_net({1, 5, 2, 1, 5, 2, 1, 5, 2}, 2, 2);
  EXPECT_TRUE(across.equal_rows);
  EXPECT_FALSE(across.equal_columns);
  EXPECT_EQ(GaussRemainder(across).bound(exact_gauss_points(2)), 0.0);
  EXPECT_GT(GaussRemainder(across).bound(exact_gauss_points(2) - 1), 0.0);
  EXPECT_TRUE(transposed(across).equal_columns);
  EXPECT_GT(GaussRemainder(transposed(across)).bound(20), 0.0);
  EXPECT_EQ(GaussRemainder(across).points(1e-16, 2, 32), exact_gauss_points(2));
}

TEST(GaussRemainder, UnresolvedCellsHaveAFiniteBound) {
  const WeightNet steep = bezier_net({1, 1, 1e12, 1e12}, 1, 1);
  const GaussRemainder remainder(steep);
  EXPECT_TRUE(std::isfinite(remainder.bound(32)));
  EXPECT_GT(remainder.bound(32), 1.0);
  EXPECT_EQ(remainder.points(1e-15, 2, 32), 33);
  EXPECT_TRUE(std::isinf(remainder.bound(1)));
}

TEST(WeightNet, ReproducesTheDenominatorOnEverySpanAndHalf) {
  std::mt19937 random(504);
  for (int round = 0; round < 8; ++round) {
    const KnotVector u = testing::random_clamped(random, 1 + round % 4, 2);
    const KnotVector v = testing::random_unclamped(random, 1 + round % 3, 3);
    const auto count = static_cast<size_t>(u.size()) * static_cast<size_t>(v.size());
    const auto weights = weights_of_ratio(random, count, 100.0);
    std::vector<Vec3> poles;
    for (double w : weights) poles.emplace_back(w, 0.0, 0.0);
    const Surface denominator(u, v, poles);
    for (int su = 0; su < static_cast<int>(u.spans().size()); ++su) {
      for (int sv = 0; sv < static_cast<int>(v.spans().size()); ++sv) {
        const WeightNet net = net_of(u, v, weights, su, sv);
        const auto [left, right] = halves(net);
        const int i = u.spans()[static_cast<size_t>(su)];
        const int j = v.spans()[static_cast<size_t>(sv)];
        for (double t : {0.0, 0.3, 0.5, 0.9}) {
          const double s = 0.6;
          const auto value = [&](const WeightNet& of, double at) {
            double sum = 0.0;
            for (int k = 0; k < of.rows; ++k) {
              for (int l = 0; l < of.columns; ++l) {
                const auto bernstein = [](int d, int m, double x) {
                  return std::tgamma(d + 1.0) / (std::tgamma(m + 1.0) * std::tgamma(d - m + 1.0)) *
                         std::pow(x, m) * std::pow(1 - x, d - m);
                };
                sum += of(k, l) * bernstein(of.rows - 1, k, at) * bernstein(of.columns - 1, l, s);
              }
            }
            return sum;
          };
          const double w =
              denominator.point(u[i] + t * (u[i + 1] - u[i]), v[j] + s * (v[j + 1] - v[j])).x();
          EXPECT_NEAR(value(net, t), w, 1e-12 * w);
          EXPECT_NEAR(t <= 0.5 ? value(left, 2 * t) : value(right, 2 * t - 1), w, 1e-12 * w);
        }
      }
    }
  }
}

TEST(QuadratureChoice, EveryCellKeepsItsShare) {
  std::mt19937 random(505);
  for (double ratio : {1.5, 10.0, 100.0, 1e4}) {
    const KnotVector u = testing::random_clamped(random, 3, 2);
    const KnotVector v = testing::random_clamped(random, 2, 3);
    const auto count = static_cast<size_t>(u.size()) * static_cast<size_t>(v.size());
    const QuadratureChoice choice = choose_quadrature(u, v, weights_of_ratio(random, count, ratio));
    ASSERT_EQ(choice.u.size(), u.spans().size());
    ASSERT_EQ(choice.v.size(), v.spans().size());
    for (size_t su = 0; su < choice.u.size(); ++su) {
      for (size_t sv = 0; sv < choice.v.size(); ++sv) {
        const auto cells = static_cast<double>(choice.u[su].size() + choice.v[sv].size());
        EXPECT_LE(choice.remainder[su * choice.v.size() + sv], 2.5e-16 * cells) << ratio;
      }
    }
  }
}

TEST(QuadratureChoice, LeavesSpansAloneWhereWeightsAreEqual) {
  // One heavy pole at the end of a long strip: the far spans keep the exact rule and miss nothing.
  const KnotVector u = KnotVector::uniform(2, 8);
  const KnotVector v = KnotVector::uniform(1, 1);
  std::vector<double> weights(static_cast<size_t>(u.size()) * 2, 1.0);
  weights[0] = weights[1] = 50.0;
  const QuadratureChoice choice = choose_quadrature(u, v, weights);
  EXPECT_GT(choice.u[0].size(), 1u);
  for (size_t s = 1; s < 8; ++s) {
    EXPECT_EQ(choice.u[s], (SpanCells{{0.0, 1.0, exact_gauss_points(2)}})) << s;
    EXPECT_EQ(choice.remainder[s], 0.0);
  }
  EXPECT_EQ(choice.v[0], (SpanCells{{0.0, 1.0, exact_gauss_points(1)}}));
}

TEST(QuadratureChoice, WeightsThatAreNotPositiveAreTheCallersBug) {
  const KnotVector knots = KnotVector::uniform(1, 1);
  for (double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(choose_quadrature(knots, knots, {1.0, 2.0, bad, 1.0}), PreconditionError) << bad;
  }
}

}  // namespace
}  // namespace isochor::internal
