// Twice the precision of double, against rational arithmetic.
#include "isochor/base/double_double.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isochor/exact/rational.h"

namespace isochor {
namespace {

Rational exact(const DoubleDouble& a) { return Rational(a.high()) + Rational(a.low()); }

// Numbers of very different sizes, some nearly opposite.
class Source {
 public:
  DoubleDouble next() {
    const double high = std::ldexp(mantissa_(random_), exponent_(random_));
    return DoubleDouble(high) + DoubleDouble(high * 0x1p-54 * mantissa_(random_));
  }

 private:
  std::mt19937 random_{81};
  std::uniform_real_distribution<double> mantissa_{-1.0, 1.0};
  std::uniform_int_distribution<int> exponent_{-40, 40};
};

void expect_accurate(const DoubleDouble& computed, const Rational& wanted, double* worst) {
  EXPECT_EQ(computed.high() + computed.low(), computed.high());  // law (1)
  if (wanted == Rational(0)) {
    EXPECT_EQ(computed.high(), 0.0);
    return;
  }
  const double error = ((exact(computed) - wanted) / wanted).abs().to_double();
  EXPECT_LE(error, DoubleDouble::kUnit);
  *worst = std::max(*worst, error);
}

TEST(DoubleDouble, AccuracyOfEveryOperation) {
  Source source;
  double worst = 0.0;
  for (int round = 0; round < 20000; ++round) {
    const DoubleDouble a = source.next(), b = source.next();
    expect_accurate(a + b, exact(a) + exact(b), &worst);
    expect_accurate(a - b, exact(a) - exact(b), &worst);
    expect_accurate(a * b, exact(a) * exact(b), &worst);
    if (b.high() != 0.0) expect_accurate(a / b, exact(a) / exact(b), &worst);
  }
  EXPECT_GT(worst, 0x1p-110);  // the bound is near what happens
}

TEST(DoubleDouble, CancellationKeepsTheRelativeError) {
  Source source;
  double worst = 0.0;
  for (int round = 0; round < 5000; ++round) {
    const DoubleDouble a = source.next();
    const DoubleDouble near =
        -a * (DoubleDouble(1.0) + DoubleDouble(std::ldexp(1.0, -round % 100)));
    expect_accurate(a + near, exact(a) + exact(near), &worst);
  }
}

TEST(DoubleDouble, SumsAndProductsOfDoublesAreExact) {
  std::mt19937 random(82);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int round = 0; round < 5000; ++round) {
    const double a = number(random), b = std::ldexp(number(random), round % 90 - 45);
    EXPECT_EQ(exact(DoubleDouble::two_sum(a, b)), Rational(a) + Rational(b));
    EXPECT_EQ(exact(DoubleDouble::two_product(a, b)), Rational(a) * Rational(b));
  }
}

TEST(DoubleDouble, SignAndAssignment) {
  DoubleDouble a(3.0);
  a += DoubleDouble(0x1p-60);
  EXPECT_EQ(exact(abs(-a)), exact(a));
  EXPECT_EQ(to_double(a), 3.0);
  a -= DoubleDouble(3.0);
  EXPECT_EQ(to_double(a), 0x1p-60);
  a *= DoubleDouble(0x1p60);
  EXPECT_EQ(to_double(a), 1.0);
}

}  // namespace
}  // namespace isochor
