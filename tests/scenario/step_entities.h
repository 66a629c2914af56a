// A small reader for the entities of STEP files, for tests that must not depend on a CAD kernel.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "isochor/bspline/surface.h"

namespace isochor::testing {

// "#12=NAME(...);" by number; the value is the text after "=", without line breaks.
std::map<int, std::string> step_entities(const std::string& text);

// The entities whose text begins with NAME( , in file order.
std::vector<int> entities_named(const std::map<int, std::string>& entities,
                                const std::string& name);

// A polynomial B-spline surface or curve with its own doubles; clamped or not.
Surface step_surface(const std::map<int, std::string>& entities, int number);
struct StepCurve {
  KnotVector knots;
  std::vector<Vec3> poles;
};
StepCurve step_curve(const std::map<int, std::string>& entities, int number);

std::string read_text(const std::string& path);

}  // namespace isochor::testing
