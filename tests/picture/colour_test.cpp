#include "isochor/picture/colour.h"

#include <gtest/gtest.h>

#include <cmath>

#include "isochor/base/error.h"

namespace isochor {
namespace {

double lightness(const Rgb& linear) { return oklab_from_linear(linear)[0]; }

TEST(Colour, ConversionsAreInverseToEachOther) {
  for (double r : {0.0, 0.01, 0.5, 1.0}) {
    for (double b : {0.0, 0.3, 0.99}) {
      const Rgb colour = {r, 0.4, b};
      const Rgb back = srgb_from_linear(linear_from_srgb(colour));
      const Rgb lab_back = linear_from_oklab(oklab_from_linear(colour));
      for (size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(back[k], colour[k], 1e-6);
        EXPECT_NEAR(lab_back[k], colour[k], 1e-6);
      }
    }
  }
}

TEST(Colour, WhiteHasLightnessOneAndNoHue) {
  const auto lab = oklab_from_linear({1.0, 1.0, 1.0});
  EXPECT_NEAR(lab[0], 1.0, 1e-6);
  EXPECT_NEAR(lab[1], 0.0, 1e-6);
  EXPECT_NEAR(lab[2], 0.0, 1e-6);
}

TEST(ColourScale, LightnessFallsFromZeroToEitherEnd) {
  const ColourScale scale(2.0);
  for (double sign : {1.0, -1.0}) {
    double last = lightness(scale.at(0.0));
    for (int k = 1; k <= 20; ++k) {
      const double here = lightness(scale.at(sign * 0.1 * k));
      EXPECT_LT(here, last) << sign * 0.1 * k;
      last = here;
    }
  }
}

TEST(ColourScale, OppositeValuesAreEquallyLight) {
  const ColourScale scale(1.0);
  for (double value : {0.1, 0.4, 0.8, 1.0}) {
    EXPECT_NEAR(lightness(scale.at(value)), lightness(scale.at(-value)), 0.02) << value;
  }
}

TEST(ColourScale, OutwardIsRedInwardIsBlueZeroIsGrey) {
  const ColourScale scale(0.5);
  EXPECT_GT(scale.at(0.4)[0], 2.0 * scale.at(0.4)[2]);
  EXPECT_GT(scale.at(-0.4)[2], 2.0 * scale.at(-0.4)[0]);
  EXPECT_NEAR(scale.at(0.0)[0], scale.at(0.0)[2], 1e-3);
  EXPECT_EQ(scale.at(7.0), scale.at(0.5)) << "beyond the end";
}

TEST(ColourScale, TicksAreRoundSymmetricAndFew) {
  for (double limit : {1.0, 0.31, 7.4e-7, 123.0, 4.0, 9.99e5, 2.5}) {
    const std::vector<double> ticks = ColourScale(limit).ticks();
    EXPECT_GE(ticks.size(), 5u) << limit;
    EXPECT_LE(ticks.size(), 11u) << limit;
    EXPECT_LE(ticks.back(), limit * (1.0 + 1e-9));
    EXPECT_EQ(ticks[ticks.size() / 2], 0.0);
    for (size_t k = 0; k < ticks.size(); ++k) EXPECT_EQ(ticks[k], -ticks[ticks.size() - 1 - k]);
    EXPECT_LE(short_number(ticks.back(), 3).size(), 7u) << "round";
  }
}

TEST(ColourScale, TicksAreFoundButZeroIsNot) {
  const ColourScale scale(1.0);
  const double tick = scale.ticks().back();
  EXPECT_TRUE(scale.near_tick(tick + 0.001, 0.002));
  EXPECT_FALSE(scale.near_tick(tick + 0.003, 0.002));
  EXPECT_FALSE(scale.near_tick(0.0, 0.002));
}

TEST(ColourScale, LimitMustBePositive) {
  EXPECT_THROW(ColourScale(0.0), PreconditionError);
  EXPECT_THROW(ColourScale(std::nan("")), PreconditionError);
}

TEST(ShortNumber, HasNoNeedlessDigits) {
  EXPECT_EQ(short_number(0.2), "0.2");
  EXPECT_EQ(short_number(-12.50), "-12.5");
  EXPECT_EQ(short_number(1.0 / 3.0), "0.3333");
  EXPECT_EQ(short_number(0.0), "0");
}

}  // namespace
}  // namespace isochor
