// What the locks of a model leave free, and what happens when it is moved.
#pragma once

#include <set>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "support/splines.h"

namespace isochor::testing {

// The points that are locked; without continuity: only those that keep positions.
inline std::set<int> locked_points(const PatchModel& model, bool with_continuity = true) {
  std::set<int> points;
  for (const Lock& lock : model.locks) {
    if (with_continuity || !model.lock_reasons[static_cast<size_t>(lock.reason)].continuity) {
      points.insert(lock.point);
    }
  }
  return points;
}

// Moves every point that is not locked, nor tied to a locked one, at random; tied points together.
inline std::vector<Vec3> shaken(const PatchModel& model, double amount,
                                bool with_continuity = true) {
  std::mt19937 random(71);
  const PointClasses classes = point_classes(model);
  auto by = random_points(random, classes.representative.size());
  for (int point : locked_points(model, with_continuity)) {
    by[static_cast<size_t>(classes.class_of[static_cast<size_t>(point)])] = Vec3::Zero();
  }
  std::vector<Vec3> at = model.points;
  for (size_t i = 0; i < at.size(); ++i) {
    at[i] += amount * by[static_cast<size_t>(classes.class_of[i])];
  }
  return at;
}

}  // namespace isochor::testing
