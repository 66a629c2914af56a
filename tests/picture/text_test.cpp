#include "isochor/picture/text.h"

#include <gtest/gtest.h>

namespace isochor {
namespace {

Image white(int width, int height) {
  Image image(width, height);
  for (auto& byte : image.rgb) byte = 255;
  return image;
}

// The columns and rows that text changed.
struct Ink {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
  long amount = 0;
};
Ink ink_of(const std::string& text, const TextStyle& style = {}) {
  Image image = white(400, 60);
  draw_text(image, 20.0, 40.0, text, style);
  Ink ink;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int dark = 255 - image.pixel(x, y)[1];
      if (dark < 24) continue;
      ink.left = std::min(ink.left, x), ink.right = std::max(ink.right, x);
      ink.top = std::min(ink.top, y), ink.bottom = std::max(ink.bottom, y);
      ink.amount += dark;
    }
  }
  return ink;
}

TEST(Text, EveryPrintableCharacterHasAShapeOfItsOwn) {
  const Ink box = ink_of("\xEF\xBF\xBD");
  for (char c = '!'; c <= '~'; ++c) {
    const Ink ink = ink_of(std::string(1, c));
    EXPECT_GT(ink.amount, 100) << c;
    EXPECT_NE(ink.amount, box.amount) << c << " is shown as the box of unknown characters";
    EXPECT_GE(ink.left, 18) << c;
    EXPECT_LE(ink.right, 20 + text_width(std::string(1, c), {}) + 2) << c;
  }
  EXPECT_EQ(ink_of(" ").amount, 0);
}

TEST(Text, UnitsAndSignsHaveShapes) {
  const long box = ink_of("\xEF\xBF\xBD").amount;
  for (const char* sign : {"²", "³", "µ", "±", "×", "°", "→", "≤", "Δ", "…", "–"}) {
    EXPECT_GT(ink_of(sign).amount, 0) << sign;
    EXPECT_NE(ink_of(sign).amount, box) << sign;
    EXPECT_EQ(text_width(std::string(sign) + sign, {}) > text_width(sign, {}), true);
  }
}

TEST(Text, CapitalsStandOnTheBaselineWithTheAskedHeight) {
  for (double height : {8.0, 14.0, 24.0}) {
    TextStyle style;
    style.cap_height = height;
    const Ink ink = ink_of("H", style);
    EXPECT_NEAR(ink.bottom - ink.top + 1, height, 0.25 * height + 2.0);
    EXPECT_NEAR(ink.bottom, 40, 0.1 * height + 2.0);
  }
}

TEST(Text, WidthIsWhatIsDrawn) {
  const std::string text = "volume 12.5 m³";
  const Ink ink = ink_of(text);
  EXPECT_NEAR(ink.right - ink.left + 1, text_width(text, {}), 3.0);
  EXPECT_EQ(text_width("", {}), 0.0);
}

TEST(Text, BrokenUtf8AndPlacesOutsideAreHarmless) {
  Image image = white(10, 10);
  draw_text(image, -100.0, 5.0, "abc", {});
  draw_text(image, 5.0, 500.0, "abc\xC3", {});
  draw_text(image, 5.0, -500.0, "\xFF\x80", {});
  EXPECT_EQ(image, white(10, 10));
  EXPECT_GT(text_width("\xE2\x82", {}), 0.0);
}

TEST(Text, FittedTextIsAPrefixWithAnEllipsis) {
  const TextStyle style;
  EXPECT_EQ(fitted("short", style, 500.0), "short");
  const std::string cut = fitted("a long line of text that does not fit", style, 120.0);
  EXPECT_LE(text_width(cut, style), 120.0);
  EXPECT_GT(text_width(cut, style), 90.0);
  EXPECT_EQ(cut.substr(0, 6), "a long");
  EXPECT_EQ(cut.substr(cut.size() - 3), "…");
}

}  // namespace
}  // namespace isochor
