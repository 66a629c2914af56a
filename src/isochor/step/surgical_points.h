// New points for old ones in the text of a STEP file. Internal to `step`; no OpenCASCADE.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include "isochor/base/vec3.h"
#include "isochor/step/part21_edit.h"

namespace isochor::internal {

// Poles, curves and vertices that shared a point and moved to the same place share the new one.
class NewPoints {
 public:
  NewPoints(const Part21File& file, Part21Edit& edit) : file_(file), edit_(edit) {}

  // The point in the place of `old` at `place`: the old one when that is where it is.
  std::uint64_t at(const Part21Instance& old, const Vec3& place);
  // A point that takes the place of none.
  std::uint64_t fresh(const Part21Instance& beside, const Vec3& place);

 private:
  std::uint64_t append(const Part21Instance& beside, const std::string& name, const Vec3& place);

  const Part21File& file_;
  Part21Edit& edit_;
  std::map<std::pair<std::uint64_t, std::array<double, 3>>, std::uint64_t> known_;
};

}  // namespace isochor::internal
