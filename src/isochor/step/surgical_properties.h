// Volumes, areas and centroids that a STEP file states, after an edit. Internal to `step`; no
// OpenCASCADE.
//
// "Geometric validation properties" let the next program check that it read the same shape. After
// an edit they are recomputed where the file has one solid, else those of the edited parts and of
// assemblies are dropped.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/step/part21_edit.h"
#include "isochor/step/part21_references.h"

namespace isochor::internal {

// How the measures of the file's only solid changed. Factors need no units.
struct MeasureChange {
  bool known = false;  // false: there are several solids, or it is open
  double volume_factor = 1.0, area_factor = 1.0;
  Vec3 centroid_shift = Vec3::Zero();
};

bool states_measures(const Part21File& file);

// Appends a notice for what was recomputed, dropped or left although it may no longer hold, and for
// triangles that the file has besides its faces. `faces`: the entities that were edited.
void update_measures(const Part21File& file, const Part21References& references,
                     const std::set<std::uint64_t>& faces, const MeasureChange& change,
                     Part21Edit& edit, std::vector<std::string>& notices);

}  // namespace isochor::internal
