// Conversions between doubles, decimals and rationals, against the C library and long double.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>

#include "isochor/base/error.h"
#include "isochor/exact/rational.h"

namespace isochor {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSmallest = std::numeric_limits<double>::denorm_min();
constexpr double kLargest = std::numeric_limits<double>::max();

Rational power_of_two(long exponent) { return Rational(1).scaled_by_power_of_two(exponent); }

// glibc's strtod rounds correctly, for as many digits as there are.
TEST(Conversion, DecimalsRoundLikeTheCLibrary) {
  std::mt19937_64 random(31);
  std::uniform_int_distribution<int> digit(0, 9);
  std::uniform_int_distribution<int> exponent(-345, 310);
  for (int round = 0; round < 1500; ++round) {
    std::string text = round % 2 == 0 ? "" : "-";
    text += static_cast<char>('1' + digit(random) % 9);
    text += '.';
    for (int k = 0; k < 1 + round % 40; ++k) text += static_cast<char>('0' + digit(random));
    text += "e" + std::to_string(exponent(random));
    EXPECT_EQ(Rational::parse(text).to_double(), std::strtod(text.c_str(), nullptr)) << text;
  }
}

TEST(Conversion, PrintedDoublesComeBack) {
  std::mt19937_64 random(32);
  for (int round = 0; round < 300; ++round) {
    const double x = std::ldexp(static_cast<double>(static_cast<long>(random()) >> 10),
                                static_cast<int>(random() % 2000) - 1080);
    char shortest[64];
    std::snprintf(shortest, sizeof(shortest), "%.17g", x);
    EXPECT_EQ(Rational::parse(shortest).to_double(), x);
    char all[1200];  // every digit there is
    std::snprintf(all, sizeof(all), "%.1100f", x);
    if (std::abs(x) < 1e60) {
      EXPECT_EQ(Rational::parse(all), Rational(x)) << shortest;
    }
  }
}

TEST(Conversion, HalfwayCasesGoToTheEvenNeighbour) {
  for (int exponent : {-1000, -1, 0, 52, 900}) {
    const Rational unit = power_of_two(exponent - 52);
    for (long mantissa : {(1L << 52), (1L << 52) + 1, (1L << 53) - 2, (1L << 53) - 1}) {
      const Rational half = (Rational(mantissa) + Rational(Integer(1), Integer(2))) * unit;
      const long even = mantissa % 2 == 0 ? mantissa : mantissa + 1;
      EXPECT_EQ(Rational(half.to_double()), Rational(even) * unit) << exponent << ' ' << mantissa;
      EXPECT_EQ((-half).to_double(), -half.to_double());
      // A part in 2^3000 to either side decides.
      const Rational hair = unit * power_of_two(-3000);
      EXPECT_EQ(Rational((half + hair).to_double()), Rational(mantissa + 1) * unit);
      EXPECT_EQ(Rational((half - hair).to_double()), Rational(mantissa) * unit);
    }
  }
}

TEST(Conversion, SubnormalsHaveFewerBits) {
  const Rational step(kSmallest);
  for (long k : {1L, 2L, 3L, 1000L, (1L << 52) - 1, 1L << 52}) {
    const Rational at = Rational(k) * step;
    const double exact = std::ldexp(static_cast<double>(k), -1074);
    EXPECT_EQ(at.to_double(), exact);
    const Rational half = at + step / Rational(2);
    EXPECT_EQ(half.to_double(), std::ldexp(static_cast<double>(k % 2 == 0 ? k : k + 1), -1074));
    EXPECT_EQ((half - step * power_of_two(-80)).to_double(), exact);
    const Enclosure around = half.enclosure();
    EXPECT_EQ(around.low, exact);
    EXPECT_EQ(around.high, std::nextafter(exact, kInfinity));
  }
  // Just above half of the smallest rounds up, half itself to the even zero.
  EXPECT_EQ((step / Rational(2)).to_double(), 0.0);
  EXPECT_EQ((step / Rational(2) + step * power_of_two(-200)).to_double(), kSmallest);
}

TEST(Conversion, TheEdgeOfTheRange) {
  const Rational limit = power_of_two(1024);  // the double that does not exist
  const Rational half_step = power_of_two(970);
  EXPECT_EQ((limit - half_step).to_double(), kInfinity) << "a tie between odd and even";
  EXPECT_EQ((limit - half_step - Rational(1)).to_double(), kLargest);
  EXPECT_EQ((half_step - limit).to_double(), -kInfinity);
  EXPECT_EQ(limit.to_double(), kInfinity);
  EXPECT_EQ(power_of_two(100000).to_double(), kInfinity);
  EXPECT_EQ(power_of_two(-100000).to_double(), 0.0);
  const Enclosure above = limit.enclosure();
  EXPECT_EQ(above.low, kLargest);
  EXPECT_EQ(above.high, kInfinity);
  const Enclosure below = (-limit).enclosure();
  EXPECT_EQ(below.low, -kInfinity);
  EXPECT_EQ(below.high, -kLargest);
  const Enclosure nothing = (-power_of_two(-100000)).enclosure();
  EXPECT_EQ(nothing.low, -kSmallest);
  EXPECT_EQ(nothing.high, 0.0);
}

// A quotient of 64-bit integers in long double is within one part in 2^63.
TEST(Conversion, QuotientsAgreeWithLongDouble) {
  std::mt19937_64 random(33);
  for (int round = 0; round < 500; ++round) {
    const long a = static_cast<long>(random() >> 2) - (1L << 61);
    const long b = static_cast<long>(random() >> 2) + 1;
    const long double quotient = static_cast<long double>(a) / static_cast<long double>(b);
    const double rounded = Rational(Integer(a), Integer(b)).to_double();
    EXPECT_LE(std::abs(static_cast<long double>(rounded) - quotient),
              std::abs(quotient) * 0x1.01p-53L);
  }
}

TEST(Conversion, ZeroHasNoSign) {
  EXPECT_EQ(Rational(-0.0), Rational(0));
  EXPECT_FALSE(std::signbit(Rational(-0.0).to_double()));
  EXPECT_FALSE(std::signbit(Rational::parse("-0").to_double()));
  EXPECT_EQ(Rational::parse("-0.000e9999").to_string(), "0");
  EXPECT_EQ(Rational(0).sign(), 0);
  EXPECT_TRUE((Rational(1) - Rational(1)).is_zero());
}

TEST(Conversion, TheLargestDecimalExponents) {
  const Rational large = Rational::parse("1e9999");
  EXPECT_EQ(large * Rational::parse("1e-9999"), Rational(1));
  EXPECT_EQ(large.to_string().size(), 10000u);
  EXPECT_EQ(large.to_double(), kInfinity);
  EXPECT_THROW((void)Rational::parse("1e10000"), InputError);
  EXPECT_THROW((void)Rational::parse("1e-10000"), InputError);
  EXPECT_EQ(Rational::parse("1e0000000000000000000001"), Rational(10));
}

TEST(Conversion, LongTextsAreCutInMessagesOnly) {
  const std::string digits(300, '7');
  EXPECT_EQ(Rational::parse(digits).to_string(), digits);
  try {
    static_cast<void>(Rational::parse(digits + "x"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.entity().size(), std::string("number \"\"").size() + 60);
    EXPECT_EQ(error.reason(), "unexpected character 'x'");
  }
}

TEST(Conversion, MachineIntegersAreExact) {
  for (long value : {0L, 1L, -1L, std::numeric_limits<long>::max(),
                     std::numeric_limits<long>::min(), 1L << 62, -(1L << 62) + 1}) {
    EXPECT_EQ(Rational(value).to_string(), std::to_string(value));
    EXPECT_EQ(Integer(value).to_string(), std::to_string(value));
    EXPECT_EQ(Rational(Integer(value)).numerator(), Integer(value));
    EXPECT_EQ(Rational(value).denominator(), Integer(1));
  }
  EXPECT_EQ(Rational(std::numeric_limits<long>::max()).to_double(), 0x1p63) << "rounded up";
  EXPECT_EQ(Rational(-7), Rational(-7L));
}

TEST(Conversion, OrderOfMixedMagnitudes) {
  const Rational numbers[] = {-power_of_two(2000),    Rational(-kLargest),  Rational(-1),
                              Rational(-kSmallest),   -power_of_two(-3000), Rational(0),
                              power_of_two(-3000),    Rational(kSmallest),  Rational(0.1),
                              Rational::parse("1/3"), Rational(kLargest),   power_of_two(2000)};
  const size_t count = std::size(numbers);
  for (size_t i = 0; i < count; ++i) {
    for (size_t j = 0; j < count; ++j) {
      EXPECT_EQ(compare(numbers[i], numbers[j]), i < j ? -1 : (i > j ? 1 : 0));
      EXPECT_EQ(numbers[i] <= numbers[j], i <= j);
      EXPECT_EQ(numbers[i] > numbers[j], i > j);
    }
  }
}

}  // namespace
}  // namespace isochor
