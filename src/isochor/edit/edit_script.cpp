#include "isochor/edit/edit_script.h"

namespace isochor {

const char* name_of(Method method) {
  switch (method) {
    case Method::kIsotropic:
      return "isotropic";
    case Method::kAxis:
      return "axis";
    case Method::kTaylor:
      return "taylor";
  }
  return "?";
}

const char* name_of(Continuity continuity) {
  switch (continuity) {
    case Continuity::kMeasured:
      return "measured";
    case Continuity::kTangent:
      return "G1";
    case Continuity::kC0:
      return "C0";
  }
  return "?";
}

}  // namespace isochor
