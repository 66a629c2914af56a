// How far one surface is from another, for comparing models that need not correspond.
//
// Law: the magnitude is the distance to the nearest point of the reference's triangles; the sign is
// positive where the point lies on the outer side of the reference there.
#pragma once

#include <vector>

#include "isochor/io/mesh.h"

namespace isochor {

// One signed distance for each position of `mesh`. The reference must not be empty.
// Cost: O((#positions + #triangles) log #triangles) for surfaces that lie near each other.
std::vector<double> signed_deviation(const Mesh& mesh, const Mesh& reference);

}  // namespace isochor
