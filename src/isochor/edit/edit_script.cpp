#include "isochor/edit/edit_script.h"

#include <algorithm>

#include "isochor/base/error.h"

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

std::vector<ClosingPlane> closing_planes(const EditScript& script) {
  std::vector<ClosingPlane> planes = script.close;
  const auto holds = [](const std::vector<ClosingPlane>& list, const ClosingPlane& plane) {
    return std::any_of(list.begin(), list.end(), [&](const ClosingPlane& other) {
      return same_plane(plane, other) && plane.mirror == other.mirror;
    });
  };
  const auto same = [&](const std::vector<ClosingPlane>& a, const std::vector<ClosingPlane>& b) {
    return a.size() == b.size() &&
           std::all_of(a.begin(), a.end(), [&](const auto& plane) { return holds(b, plane); });
  };
  for (size_t k = 0; k < script.edits.size(); ++k) {
    const std::vector<ClosingPlane>& own = script.edits[k].close;
    if (own.empty()) continue;
    if (planes.empty() && k == 0) planes = own;
    if (!same(own, planes)) {
      throw InputError("", "edits[" + std::to_string(k) + "].close",
                       "all edits of a file are made on one body, so they must name the same "
                       "closing planes: write \"close\" once, beside \"edits\"");
    }
  }
  return planes;
}

}  // namespace isochor
