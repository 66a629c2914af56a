#include "isochor/exact/rational.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>

#include "isochor/base/error.h"

namespace isochor {
namespace {

using ::testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSmallest = std::numeric_limits<double>::denorm_min();
constexpr double kLargest = std::numeric_limits<double>::max();

// Doubles of all magnitudes, subnormals included.
double random_double(std::mt19937_64& random) {
  for (;;) {
    const std::uint64_t bits = random();
    double x = 0.0;
    static_assert(sizeof(x) == sizeof(bits));
    std::memcpy(&x, &bits, sizeof(x));
    if (std::isfinite(x)) return x;
  }
}

TEST(Rational, Field) {
  std::mt19937_64 random(21);
  const auto number = [&] {
    const auto part = [&] { return static_cast<long>(random() >> 3) - (1L << 60); };
    return Rational(Integer(part()) * Integer(part()), Integer(part() | 1));
  };
  for (int round = 0; round < 100; ++round) {
    const Rational a = number();
    const Rational b = number();
    const Rational c = number();
    EXPECT_EQ(a + b, b + a);
    EXPECT_EQ((a + b) + c, a + (b + c));
    EXPECT_EQ(a * (b - c), a * b - a * c);
    EXPECT_EQ((a / b) * b, a);
    EXPECT_EQ(a - a, Rational());
    EXPECT_EQ(a + -a, Rational(0));
    EXPECT_EQ(a.abs().sign(), 1);
    EXPECT_EQ(Rational(a.numerator(), a.denominator()), a);
    EXPECT_EQ(a < b, (a - b).sign() < 0);
    EXPECT_EQ(a >= b, (a - b).sign() >= 0);
  }
}

TEST(Rational, LowestTermsWithPositiveDenominator) {
  const Rational r(Integer(6), Integer(-4));
  EXPECT_EQ(r.to_string(), "-3/2");
  EXPECT_EQ(r.denominator(), Integer(2));
  EXPECT_EQ(Rational(Integer(0), Integer(-7)).to_string(), "0");
}

TEST(Rational, Dyadic) {
  std::mt19937_64 random(22);
  for (int round = 0; round < 2000; ++round) {
    const double x = random_double(random);
    EXPECT_EQ(Rational(x).to_double(), x);
  }
  for (double x :
       {0.0, 1.0, -0.1, kSmallest, -kSmallest, kLargest, 0x1p-1022, 0x1.fffffffffffffp-1023}) {
    EXPECT_EQ(Rational(x).to_double(), x);
    const Enclosure tight = Rational(x).enclosure();
    EXPECT_EQ(tight.low, x);
    EXPECT_EQ(tight.high, x);
  }
  EXPECT_EQ(Rational(0.75).to_string(), "3/4");
  EXPECT_EQ(Rational(0.1).to_string(), "3602879701896397/36028797018963968");
}

// No neighbour of the answer is nearer; at equal distance the answer is the even one.
void expect_nearest(const Rational& value) {
  const double answer = value.to_double();
  ASSERT_TRUE(std::isfinite(answer));
  const Rational distance = (Rational(answer) - value).abs();
  for (double towards : {-kInfinity, kInfinity}) {
    const double neighbour = std::nextafter(answer, towards);
    if (!std::isfinite(neighbour)) continue;
    const Rational other = (Rational(neighbour) - value).abs();
    EXPECT_LE(distance, other) << value.to_string();
    if (distance == other) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &answer, sizeof(bits));
      EXPECT_EQ(bits & 1u, 0u) << value.to_string();
    }
  }
  const Enclosure around = value.enclosure();
  EXPECT_LE(Rational(around.low), value);
  EXPECT_GE(Rational(around.high), value);
  EXPECT_TRUE(around.low == around.high || std::nextafter(around.low, kInfinity) == around.high);
  EXPECT_EQ(around.low == around.high, distance.is_zero());
}

TEST(Rational, Nearest) {
  std::mt19937_64 random(23);
  for (int round = 0; round < 1000; ++round) {
    const double x = random_double(random);
    const double y = random_double(random);
    const Rational exact(x);
    if (y != 0.0) {
      const Rational quotient = exact / Rational(y);
      if (std::isfinite(quotient.to_double())) expect_nearest(quotient);
    }
    const double next = std::nextafter(x, kInfinity);
    if (!std::isfinite(next)) continue;
    // Exactly half way, and just off it.
    const Rational half = (exact + Rational(next)) / Rational(2);
    expect_nearest(half);
    expect_nearest(half + Rational(kSmallest) * Rational(kSmallest));
    expect_nearest(half - Rational(kSmallest) * Rational(kSmallest));
  }
  for (long n = 1; n < 200; ++n) expect_nearest(Rational(Integer(n), Integer(7)));
  // On both sides of what fits a mantissa.
  std::uniform_int_distribution<long> whole(1, 1L << 54);
  for (int round = 0; round < 1000; ++round) {
    const Rational quotient(Integer(whole(random)), Integer(whole(random)));
    expect_nearest(quotient);
    expect_nearest(-quotient);
  }
  const Integer most((1L << 53) - 1);
  for (const Integer& other : {Integer(1), Integer(3), most - 1, most, most + 1, most + 2}) {
    expect_nearest(Rational(most, other));
    expect_nearest(Rational(other, most));
  }
}

TEST(Rational, RangeOfDouble) {
  const Rational tiny(kSmallest);
  EXPECT_EQ((tiny / Rational(2)).to_double(), 0.0);  // a tie, to even
  EXPECT_EQ((tiny * Rational::parse("0.51")).to_double(), kSmallest);
  EXPECT_EQ((tiny * Rational::parse("1.5")).to_double(), 2 * kSmallest);
  EXPECT_EQ((-tiny * tiny).to_double(), 0.0);
  const Rational large(kLargest);
  EXPECT_EQ((large * Rational(2)).to_double(), kInfinity);
  EXPECT_EQ((-large * large).to_double(), -kInfinity);
  const Enclosure beyond = (large * large).enclosure();
  EXPECT_EQ(beyond.low, kLargest);
  EXPECT_EQ(beyond.high, kInfinity);
  EXPECT_EQ(Rational(tiny * tiny).enclosure().low, 0.0);
  EXPECT_EQ(Rational(tiny * tiny).enclosure().high, kSmallest);
}

TEST(Rational, ScaledByPowerOfTwo) {
  EXPECT_EQ(Rational(3).scaled_by_power_of_two(-2), Rational(0.75));
  EXPECT_EQ(Rational(0.75).scaled_by_power_of_two(3), Rational(6));
  EXPECT_EQ(Rational(0).scaled_by_power_of_two(-5000), Rational(0));
}

TEST(Rational, Text) {
  const auto same = [](const char* text, long numerator, long denominator) {
    EXPECT_EQ(Rational::parse(text), Rational(Integer(numerator), Integer(denominator))) << text;
  };
  same("3/2", 3, 2);
  same("-6/4", -3, 2);
  same("0.1", 1, 10);
  same("1e-3", 1, 1000);
  same("+2.5E+7", 25000000, 1);
  same("-.5", -1, 2);
  same("7.", 7, 1);
  same("000", 0, 1);
  EXPECT_NE(Rational::parse("0.1"), Rational(0.1));
  EXPECT_EQ(Rational::parse("0.1").to_double(), 0.1);
  std::mt19937_64 random(24);
  for (int round = 0; round < 100; ++round) {
    const Rational r = Rational(random_double(random)) / Rational(3);
    EXPECT_EQ(Rational::parse(r.to_string()), r);
  }
}

TEST(Rational, TextThatIsNoNumberIsNamed) {
  const auto expect_reason = [](const char* text, const char* reason) {
    try {
      static_cast<void>(Rational::parse(text));
      ADD_FAILURE() << text << " was accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(reason)) << text;
      EXPECT_THAT(error.entity(), HasSubstr(text));
    }
  };
  expect_reason("", "the text is empty");
  expect_reason("-", "there are no digits");
  expect_reason(".", "there are no digits");
  expect_reason("1/0", "the denominator is zero");
  expect_reason("1/", "digits on both sides");
  expect_reason("/2", "digits on both sides");
  expect_reason("1/-2", "digits on both sides");
  expect_reason("1e", "the exponent has no digits");
  expect_reason("1e99999999999999999999", "the exponent is beyond 9999");
  expect_reason("1 ", "unexpected character ' '");
  expect_reason("0x10", "unexpected character 'x'");
  expect_reason("nan", "there are no digits");
  expect_reason("1.5/2", "unexpected character '/'");
}

TEST(Rational, CallersBugs) {
  EXPECT_THROW(Rational(std::nan("")), PreconditionError);
  EXPECT_THROW(Rational{kInfinity}, PreconditionError);
  EXPECT_THROW(Rational{1} / Rational{0}, PreconditionError);
  EXPECT_THROW(Rational(Integer(1), Integer(0)), PreconditionError);
}

TEST(Rational, ValuesDoNotShareState) {
  Rational a = Rational(0.1) / Rational(3);
  const Rational copy = a;
  Rational moved = std::move(a);
  moved += Rational(1);
  EXPECT_EQ(copy + Rational(1), moved);
  a = copy;
  EXPECT_EQ(a, copy);
}

TEST(Rational, ReconstructsFromItsResidue) {
  const Integer modulus(1000003);  // prime; sqrt(m / 2) = 707.1
  // -355 / 113: n = 113 residue.
  for (long residue = 0; residue < 1000003; ++residue) {
    if ((113 * residue + 355) % 1000003 != 0) continue;
    const auto found = Rational::reconstruct(Integer(residue), modulus);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(*found, Rational(Integer(-355), Integer(113)));
  }
  EXPECT_EQ(Rational::reconstruct(Integer(707), modulus), Rational(707));
  int none = 0;
  for (long residue = 0; residue < 2000; ++residue) {
    const auto found = Rational::reconstruct(Integer(residue), modulus);
    none += found ? 0 : 1;
    if (!found) continue;
    EXPECT_TRUE(
        (found->denominator() * Integer(residue) - found->numerator()).is_multiple_of(modulus));
  }
  EXPECT_GT(none, 0);
  EXPECT_THROW(Rational::reconstruct(Integer(-1), modulus), PreconditionError);
  EXPECT_THROW(Rational::reconstruct(modulus, modulus), PreconditionError);
}

}  // namespace
}  // namespace isochor
