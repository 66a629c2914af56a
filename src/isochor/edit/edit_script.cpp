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
  return continuity == Continuity::kC0 ? "C0" : "measured";
}

}  // namespace isochor
