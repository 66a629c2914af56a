// Length units of CAD files. Internal to `step`.
#pragma once

#include <string>

namespace isochor::internal {

// A unit; the default is OpenCASCADE's own, for files that name none.
struct LengthUnit {
  std::string name = "mm";  // "mm", "m", "inch", "foot", ...; "1.5 mm" when it has no name
  std::string occt = "MM";  // OpenCASCADE's name; empty when it has none
  double millimetres = 1.0;
  bool stated = false;  // false: the file does not say
};

// The unit of that many millimetres; nearly equal numbers (1e-9) are the named unit.
LengthUnit unit_of_millimetres(double millimetres);

// The unit of that name or of OpenCASCADE's name, without regard to case; `stated` false if
// unknown.
LengthUnit unit_of_name(const std::string& name);

}  // namespace isochor::internal
