#include "isochor/step/surgical_points.h"

#include "isochor/step/part21_splines.h"

namespace isochor::internal {

std::uint64_t NewPoints::at(const Part21Instance& old, const Vec3& place) {
  if (point_of(file_, old) == place) return old.number;
  const auto [it, fresh] = known_.try_emplace({old.number, {place.x(), place.y(), place.z()}}, 0);
  if (fresh) {
    const auto record = file_.record(old, "CARTESIAN_POINT");
    it->second = append(old, std::string(file_.text(record.arguments[0].span)), place);
  }
  return it->second;
}

std::uint64_t NewPoints::fresh(const Part21Instance& beside, const Vec3& place) {
  const auto [it, fresh] = known_.try_emplace({0, {place.x(), place.y(), place.z()}}, 0);
  if (fresh) it->second = append(beside, "''", place);
  return it->second;
}

std::uint64_t NewPoints::append(const Part21Instance& beside, const std::string& name,
                                const Vec3& place) {
  return edit_.append(beside, "CARTESIAN_POINT(" + name + ",(" + step_real(place.x()) + "," +
                                  step_real(place.y()) + "," + step_real(place.z()) + "))");
}

}  // namespace isochor::internal
