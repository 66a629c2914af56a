#include "isochor/exact/integer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "isochor/base/error.h"

namespace isochor {
namespace {

Integer power_of(long base, int exponent) {
  Integer result(1);
  for (int k = 0; k < exponent; ++k) result *= base;
  return result;
}

TEST(Integer, FactorialBeyondMachineWords) {
  Integer factorial(1);
  for (long k = 2; k <= 30; ++k) factorial *= k;
  EXPECT_EQ(factorial.to_string(), "265252859812191058636308480000000");
  EXPECT_EQ(factorial.bits(), 108u);
}

TEST(Integer, RingLaws) {
  std::mt19937_64 random(11);
  const auto number = [&] {
    const auto digit = [&] { return Integer(static_cast<long>(random())); };
    return digit() * digit() - digit();
  };
  for (int round = 0; round < 50; ++round) {
    const Integer a = number();
    const Integer b = number();
    const Integer c = number();
    EXPECT_EQ(a * (b + c), a * b + a * c);
    EXPECT_EQ((a * b) * c, a * (b * c));
    EXPECT_EQ(a - b, -(b - a));
    Integer sum = a;
    sum.add_product(b, c);
    EXPECT_EQ(sum, a + b * c);
    sum.add_product(b, -7);
    EXPECT_EQ(sum, a + b * c - Integer(7) * b);
    EXPECT_EQ((a * b).divided_exactly(b), a);
    sum.subtract_product(b, c);
    EXPECT_EQ(sum, a - Integer(7) * b);
    Integer product = a * b;
    product.divide_exactly(b);
    EXPECT_EQ(product, a);
    EXPECT_EQ(compare_magnitudes(a, b), compare(a.abs(), b.abs()));
    EXPECT_EQ(compare_magnitudes(a, -a), 0);
  }
}

TEST(Integer, ValuesDoNotShareState) {
  Integer a = power_of(3, 100);
  const Integer copy = a;
  Integer moved = std::move(a);
  moved += 1;
  EXPECT_EQ(copy + 1, moved);
  a = copy;
  EXPECT_EQ(a, copy);
  a = *&a;
  EXPECT_EQ(a, copy);
}

TEST(Integer, OrderSignAndShift) {
  EXPECT_LT(Integer(-3), Integer(2));
  EXPECT_LT(-power_of(2, 200), Integer(std::numeric_limits<long>::min()));
  EXPECT_EQ(Integer(-5).sign(), -1);
  EXPECT_EQ(Integer().sign(), 0);
  EXPECT_EQ(Integer(3).shifted(200), Integer(3) * power_of(2, 200));
  EXPECT_EQ(Integer(std::numeric_limits<long>::min()).to_string(), "-9223372036854775808");
}

TEST(Integer, LeastCommonMultiple) {
  EXPECT_EQ(lcm(12, -18), Integer(36));
  EXPECT_EQ(lcm(power_of(6, 40), power_of(4, 60)), power_of(2, 120) * power_of(3, 40));
  EXPECT_EQ(lcm(0, 5), Integer(0));
}

TEST(Integer, DivisionByZeroIsTheCallersBug) {
  EXPECT_THROW(Integer(4).divided_exactly(0), PreconditionError);
}

TEST(Integer, DivisionRoundsAsNamed) {
  for (long a = -12; a <= 12; ++a) {
    for (long b : {-5L, -2L, 1L, 3L, 4L}) {
      const double quotient = static_cast<double>(a) / static_cast<double>(b);
      EXPECT_EQ(Integer(a).divided_floor(b), Integer(static_cast<long>(std::floor(quotient))));
      EXPECT_EQ(Integer(a).divided_nearest(b),
                Integer(static_cast<long>(std::floor(quotient + 0.5))))
          << a << " / " << b;
      EXPECT_EQ(Integer(a).is_multiple_of(b), a % b == 0);
    }
    EXPECT_EQ(Integer(a).modulo(5), static_cast<unsigned long>(((a % 5) + 5) % 5));
  }
  EXPECT_THROW(Integer(1).divided_nearest(0), PreconditionError);
  EXPECT_TRUE(Integer(0).is_multiple_of(0));
  EXPECT_FALSE(Integer(2).is_multiple_of(0));
}

TEST(Integer, LeavesTheMachineWordOnlyWhenItMust) {
  const long largest = std::numeric_limits<long>::max();
  EXPECT_EQ(Integer(largest).to_long(), largest);
  EXPECT_EQ((Integer(largest) + 1).to_long(), std::nullopt);
  EXPECT_EQ((-Integer(largest) - 1).to_long(), std::numeric_limits<long>::min());
  EXPECT_EQ((-Integer(largest) - 2).to_long(), std::nullopt);
}

TEST(Integer, DoublesTruncateAndOverflowToInfinity) {
  EXPECT_EQ(power_of(2, 60).to_double(), std::ldexp(1.0, 60));
  EXPECT_EQ((power_of(2, 60) + 1).to_double(), std::ldexp(1.0, 60));
  EXPECT_EQ((-power_of(2, 1023)).to_double(), -std::ldexp(1.0, 1023));
  EXPECT_EQ(power_of(2, 1024).to_double(), std::numeric_limits<double>::infinity());
  EXPECT_EQ((-power_of(2, 5000)).to_double(), -std::numeric_limits<double>::infinity());
}

TEST(Integer, GreatestCommonDivisorDividesBoth) {
  EXPECT_EQ(gcd(Integer(-12), Integer(18)), Integer(6));
  EXPECT_EQ(gcd(Integer(0), Integer(-7)), Integer(7));
  EXPECT_EQ(gcd(Integer(0), Integer(0)), Integer(0));
  EXPECT_EQ(gcd(power_of(6, 80), power_of(10, 80)), power_of(2, 80));
}

}  // namespace
}  // namespace isochor
