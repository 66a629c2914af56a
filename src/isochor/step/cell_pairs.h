// What two cells of faces tell about each other. Internal to the step layer (OpenCASCADE types).
#pragma once

#include <vector>

#include "isochor/step/face_cells.h"

namespace isochor::internal {

// Curves and points that two faces share, as polylines.
using Shared = std::vector<const std::vector<Vec3>*>;
double distance_to(const Shared& shared, const Vec3& p);

bool boxes_meet(const Cell& a, const Cell& b);
// Whether a slab along `normal` parts the cells; a zero normal parts nothing.
bool parted(const Cell& a, const Cell& b, const Vec3& normal);
// All that the cells may have in common is nearer than `strip` to what is shared.
bool near_shared(const Cell& a, const Cell& b, const Shared& shared, double strip);

// Of the quadrilateral of a cell's corners; zero where that has none.
Vec3 normal_of(const FaceCells& face, const Cell& cell);
Uv middle_of(const Cell& cell);

}  // namespace isochor::internal
