// Gauss rules and compensated sums against rational arithmetic.
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "isochor/base/tolerance.h"
#include "isochor/exact/rational.h"
#include "isochor/volume/compensated_sum.h"
#include "isochor/volume/gauss.h"
#include "support/fine_quadrature.h"
#include "support/worst.h"

namespace isochor {
namespace {

using testing::Worst;

// The Legendre polynomial of the interval [0, 1] and its derivative, P_n(2 t - 1).
struct Legendre {
  Rational value, slope;
};

Legendre legendre(int n, const Rational& t) {
  const Rational x = Rational(2) * t - Rational(1);
  Rational before(0), p(1), slope_before(0), slope(0);
  for (int k = 0; k < n; ++k) {
    const Rational next = (Rational(2 * k + 1) * x * p - Rational(k) * before) / Rational(k + 1);
    const Rational next_slope =
        (Rational(2 * k + 1) * (Rational(2) * p + x * slope) - Rational(k) * slope_before) /
        Rational(k + 1);
    before = std::exchange(p, next);
    slope_before = std::exchange(slope, next_slope);
  }
  return {p, slope};
}

double step_away(double x, int units) {
  for (; units > 0; --units) x = std::nextafter(x, 2.0);
  for (; units < 0; ++units) x = std::nextafter(x, -1.0);
  return x;
}

// Each node is within two units in its last place of a root: the polynomial changes sign between
// the neighbours, exactly. The same for the distance to the other end.
TEST(GaussExact, NodesBracketRoots) {
  for (int n : {1, 2, 3, 5, 8, 17, 33, 64}) {
    const GaussRule rule = gauss_legendre(n);
    for (size_t i = 0; i<rule.nodes.size(); i += n> 20 ? 5 : 1) {
      const auto sign_at = [&](double node, bool from_end) {
        const Rational t = from_end ? Rational(1) - Rational(node) : Rational(node);
        return legendre(n, t).value.sign();
      };
      for (const bool from_end : {false, true}) {
        const double node = from_end ? rule.from_end[i] : rule.nodes[i];
        EXPECT_LE(sign_at(step_away(node, -2), from_end) * sign_at(step_away(node, 2), from_end), 0)
            << n << ' ' << i;
      }
    }
  }
}

TEST(GaussExact, WeightsAreWithinTwoUnitsInTheLastPlace) {
  for (int n : {1, 2, 3, 6, 11, 24}) {
    const GaussRule rule = gauss_legendre(n);
    for (size_t i = 0; i<rule.nodes.size(); i += n> 10 ? 4 : 1) {
      // An exact Newton step from the node leaves an error far below double; the step is rounded to
      // keep the numbers short.
      const Rational start(rule.nodes[i]);
      Legendre at = legendre(n, start);
      const Rational shift((at.value / at.slope).to_double());
      const Rational root = start - shift;
      at = legendre(n, root);
      const Rational weight = Rational(1) / (root * (Rational(1) - root) * at.slope * at.slope);
      const double exact = weight.to_double();
      EXPECT_LE(std::abs(rule.weights[i] - exact), 2 * 2 * kUnitRoundoff * exact) << n << ' ' << i;
    }
  }
}

// Before rounding to double: against fifty digits.
TEST(GaussExact, LongRulesKeepTheirStatedBound) {
  using Fifty = boost::multiprecision::cpp_bin_float_50;
  const double unit = static_cast<double>(std::numeric_limits<long double>::epsilon()) / 2;
  Worst worst("long_gauss_units", kLongGaussUnits);
  for (int n = 1; n <= kMaxGaussPoints; n += n < 20 ? 1 : 4) {
    const LongGaussRule rule = long_gauss_legendre(n);
    const auto oracle = testing::fine_gauss<Fifty>(n);
    for (size_t i = 0; i < rule.nodes.size(); ++i) {
      const auto& [node, weight] = oracle[rule.nodes.size() - 1 - i];
      const auto see = [&](long double computed, const Fifty& exact) {
        const Fifty error = abs(Fifty(computed) - exact) / exact;
        EXPECT_TRUE(worst.see(error.convert_to<double>() / unit)) << n << ' ' << i;
      };
      see(rule.nodes[i], node);
      see(rule.from_end[i], 1 - node);
      see(rule.weights[i], weight);
    }
  }
}

TEST(GaussExact, CompensatedSumsKeepTheirStatedBound) {
  std::mt19937 random(451);
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
  std::uniform_int_distribution<int> exponent(-60, 60);
  for (int round = 0; round < 50; ++round) {
    internal::CompensatedSum sum;
    Rational exact;
    Rational sizes;
    const int terms = 3 + 20 * round;
    double last = 0.0;
    for (int k = 0; k < terms; ++k) {
      // Every other term takes most of the one before away again.
      const double term =
          k % 2 == 0 ? std::ldexp(mantissa(random), exponent(random)) : -last * (1 + 0x1p-40);
      last = term;
      sum.add(term);
      exact += Rational(term);
      sizes += Rational(term).abs();
    }
    const Rational u(kUnitRoundoff);
    const Rational bound =
        u * exact.abs() + Rational(2) * Rational(terms) * Rational(terms) * u * u * sizes;
    EXPECT_LE((Rational(sum.total()) - exact).abs(), bound) << round;
  }
  EXPECT_EQ(internal::CompensatedSum().total(), 0.0);
}

}  // namespace
}  // namespace isochor
