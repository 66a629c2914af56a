#include "isochor/picture/colour.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "isochor/base/error.h"

namespace isochor {
namespace {

constexpr int kTableSize = 513;

double linear_channel(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

double srgb_channel(double c) {
  c = std::clamp(c, 0.0, 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
}

// Control colours of the scale: t in [0, 1] from zero outwards, OKLab lightness, chroma, hue (rad).
struct Stop {
  double t, lightness, chroma, hue;
};
// Small values are spread out: a counter-swell is often a tenth of the pull, and must be seen.
constexpr double kExponent = 0.65;
constexpr double kRedHue = 0.48, kBlueHue = 4.48;
constexpr Stop kStops[] = {{0.00, 0.955, 0.000, 0.0},
                           {0.08, 0.925, 0.022, 0.0},
                           {0.45, 0.735, 0.125, 0.0},
                           {0.80, 0.530, 0.168, 0.0},
                           {1.00, 0.400, 0.135, 0.0}};

Rgb diverging(double t) {
  const double size = std::pow(std::min(std::abs(t), 1.0), kExponent);
  size_t k = 0;
  while (k + 2 < std::size(kStops) && size > kStops[k + 1].t) ++k;
  const double f = (size - kStops[k].t) / (kStops[k + 1].t - kStops[k].t);
  const double lightness =
      kStops[k].lightness + f * (kStops[k + 1].lightness - kStops[k].lightness);
  const double chroma = kStops[k].chroma + f * (kStops[k + 1].chroma - kStops[k].chroma);
  const double hue = t >= 0.0 ? kRedHue : kBlueHue;
  Rgb rgb = linear_from_oklab({lightness, chroma * std::cos(hue), chroma * std::sin(hue)});
  for (double& c : rgb) c = std::clamp(c, 0.0, 1.0);
  return rgb;
}

}  // namespace

Rgb linear_from_srgb(const Rgb& c) {
  return {linear_channel(c[0]), linear_channel(c[1]), linear_channel(c[2])};
}

Rgb srgb_from_linear(const Rgb& c) {
  return {srgb_channel(c[0]), srgb_channel(c[1]), srgb_channel(c[2])};
}

std::array<double, 3> oklab_from_linear(const Rgb& c) {
  const double l = std::cbrt(0.4122214708 * c[0] + 0.5363325363 * c[1] + 0.0514459929 * c[2]);
  const double m = std::cbrt(0.2119034982 * c[0] + 0.6806995451 * c[1] + 0.1073969566 * c[2]);
  const double s = std::cbrt(0.0883024619 * c[0] + 0.2817188376 * c[1] + 0.6299787005 * c[2]);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Rgb linear_from_oklab(const std::array<double, 3>& lab) {
  const double l = lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2];
  const double m = lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2];
  const double s = lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2];
  const double l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
  return {4.0767416621 * l3 - 3.3077115913 * m3 + 0.2309699292 * s3,
          -1.2684380046 * l3 + 2.6097574011 * m3 - 0.3413193965 * s3,
          -0.0041960863 * l3 - 0.7034186147 * m3 + 1.7076147010 * s3};
}

ColourScale::ColourScale(double limit) : limit_(limit) {
  ISOCHOR_REQUIRE(limit > 0.0 && std::isfinite(limit), limit);
  for (int k = 0; k < kTableSize; ++k) {
    table_.push_back(diverging(2.0 * k / (kTableSize - 1) - 1.0));
  }
  const double rough = limit_ / 4.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  step_ = 10.0 * power;
  for (double factor : {5.0, 2.5, 2.0, 1.0}) {
    if (factor * power >= rough * (1.0 - 1e-9)) step_ = factor * power;
  }
}

Rgb ColourScale::at(double value) const {
  const double f = 0.5 * (std::clamp(value / limit_, -1.0, 1.0) + 1.0);
  return table_[static_cast<size_t>(std::lround(f * (kTableSize - 1)))];
}

std::vector<double> ColourScale::ticks() const {
  const auto count = static_cast<int>(std::floor(limit_ / step_ * (1.0 + 1e-9)));
  std::vector<double> ticks;
  for (int k = -count; k <= count; ++k) ticks.push_back(k * step_);
  return ticks;
}

bool ColourScale::near_tick(double value, double reach) const {
  const double nearest = std::round(value / step_);
  return nearest != 0.0 && std::abs(value - nearest * step_) <= reach;
}

std::string short_number(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace isochor
