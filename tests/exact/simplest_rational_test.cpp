#include "isochor/exact/simplest_rational.h"

#include <gtest/gtest.h>

#include <random>

#include "isochor/base/error.h"

namespace isochor {
namespace {

Rational ratio(long numerator, long denominator) {
  return Rational(Integer(numerator), Integer(denominator));
}

TEST(SimplestRational, WholeNumbersComeFirst) {
  EXPECT_EQ(simplest_between(ratio(-1, 3), ratio(1, 1000)), Rational(0));
  EXPECT_EQ(simplest_between(ratio(1, 3), ratio(7, 2)), Rational(1));
  EXPECT_EQ(simplest_between(ratio(5, 2), ratio(7, 2)), Rational(3));
  EXPECT_EQ(simplest_between(ratio(-7, 2), ratio(-5, 2)), Rational(-3));
  EXPECT_EQ(simplest_between(ratio(3, 1), ratio(9, 1)), Rational(3));
  EXPECT_EQ(simplest_between(Rational(0), ratio(1, 7)), Rational(0));
}

TEST(SimplestRational, AnIntervalOfOneNumberGivesIt) {
  EXPECT_EQ(simplest_between(ratio(355, 113), ratio(355, 113)), ratio(355, 113));
  EXPECT_EQ(simplest_between(ratio(-22, 7), ratio(-22, 7)), ratio(-22, 7));
}

TEST(SimplestRational, ConvergentsOfPi) {
  const Rational pi(3.14159265358979323846);
  const auto within = [&](const Rational& noise) {
    return simplest_between(pi - noise, pi + noise);
  };
  EXPECT_EQ(within(ratio(1, 500)), ratio(22, 7));
  EXPECT_EQ(within(ratio(1, 1000000)), ratio(355, 113));
}

// Against a search by rising denominators.
TEST(SimplestRational, NoSmallerDenominatorFits) {
  std::mt19937 random(9);
  std::uniform_int_distribution<long> number(1, 400);
  for (int round = 0; round < 300; ++round) {
    Rational low = ratio(number(random) - 200, number(random));
    Rational high = low + ratio(1, number(random) * number(random));
    const Rational found = simplest_between(low, high);
    EXPECT_TRUE(low <= found && found <= high);
    const long denominator = *found.denominator().to_long();
    for (long q = 1; q < denominator; ++q) {
      const Rational floor(
          (high * Rational(q)).numerator().divided_floor((high * Rational(q)).denominator()));
      EXPECT_LT(floor, low * Rational(q)) << found.to_string() << " but also over " << q;
    }
  }
}

TEST(SimplestRational, ReversedIntervalsAreTheCallersBug) {
  EXPECT_THROW(simplest_between(Rational(2), Rational(1)), PreconditionError);
}

}  // namespace
}  // namespace isochor
