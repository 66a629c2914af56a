// Colours, and the scale that turns a signed number into one.
//
// Light is added up in linear RGB; scales run in OKLab, where equal steps look equal.
//
// Laws of the diverging scale (outward red, zero light grey, inward blue):
//  (1) lightness falls strictly from zero to either end;
//  (2) opposite values are equally light.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace isochor {

// Red, green, blue, each in [0, 1]; whether sRGB or linear is said where it is used.
using Rgb = std::array<double, 3>;

Rgb linear_from_srgb(const Rgb& srgb);
Rgb srgb_from_linear(const Rgb& linear);
// Linear light to (L, a, b).
std::array<double, 3> oklab_from_linear(const Rgb& linear);
Rgb linear_from_oklab(const std::array<double, 3>& lab);

// The diverging scale over [-limit, limit]; values beyond get the end colours.
class ColourScale {
 public:
  // `limit` > 0, in the unit of the values.
  explicit ColourScale(double limit);

  double limit() const { return limit_; }
  // Linear light.
  Rgb at(double value) const;
  // Round numbers over [-limit, limit], symmetric, with zero; 5 to 11 of them.
  std::vector<double> ticks() const;
  // Is a tick other than zero at most `reach` away?
  bool near_tick(double value, double reach) const;

 private:
  double limit_;
  double step_ = 0.0;  // between ticks
  std::vector<Rgb> table_;
};

// A number for a legend, with at most `digits` significant digits and without needless zeros.
std::string short_number(double value, int digits = 4);

}  // namespace isochor
