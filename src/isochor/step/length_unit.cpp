#include "isochor/step/length_unit.h"

#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>

namespace isochor::internal {
namespace {

struct Known {
  const char* name;
  const char* occt;
  double millimetres;
};

constexpr std::array<Known, 10> kKnown = {{{"mm", "MM", 1.0},
                                           {"cm", "CM", 10.0},
                                           {"m", "M", 1000.0},
                                           {"inch", "INCH", 25.4},
                                           {"foot", "FT", 304.8},
                                           {"km", "KM", 1e6},
                                           {"mile", "MI", 1609344.0},
                                           {"mil", "MIL", 0.0254},
                                           {"um", "UM", 1e-3},
                                           {"microinch", "UIN", 2.54e-5}}};

// Conversion factors in files carry nine or more digits; the closest two known units differ more.
constexpr double kSameUnit = 1e-9;

bool same_text(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  for (size_t k = 0; k < a.size(); ++k) {
    if (std::toupper(static_cast<unsigned char>(a[k])) !=
        std::toupper(static_cast<unsigned char>(b[k]))) {
      return false;
    }
  }
  return true;
}

}  // namespace

LengthUnit unit_of_millimetres(double millimetres) {
  for (const auto& known : kKnown) {
    if (std::abs(millimetres - known.millimetres) <= kSameUnit * known.millimetres) {
      return {known.name, known.occt, known.millimetres, true};
    }
  }
  char text[48];
  std::snprintf(text, sizeof text, "%.9g mm", millimetres);
  return {text, "", millimetres, true};
}

LengthUnit unit_of_name(const std::string& name) {
  for (const auto& known : kKnown) {
    if (same_text(name, known.name) || same_text(name, known.occt)) {
      return {known.name, known.occt, known.millimetres, true};
    }
  }
  return {};
}

}  // namespace isochor::internal
