// The cross section of a closed model by a plane: its area and centroid, without tracing curves.
//
// Symbols: plane n.x = h with |n| = 1; in-plane axes a, b with a x b = n; X, Y, Z the coordinates
// of S along a, b and n, Z measured from the plane; J = X_u Y_v - X_v Y_u, the part of S_u x S_v
// along n. The part of the body below the plane is bounded by the part of the surface with Z < 0
// and by the section. A field f(X, Y) n has no divergence, so its flux through both is zero:
//   integral of f over the section = - sum_q s_q iint over {Z < 0} of f J du dv,   f = 1, X, Y.
//
// Elements are Bezier cells. Coefficients of Z tell cells above the plane (nothing) and below it (a
// Gauss rule, exact without weights). Other cells are divided until Z grows or falls along one of
// the parameters all over the cell; then each line along it has one root, and what is left of it
// is a smooth function of the other parameter, integrated by rules that are halved until they
// agree. Cells that stay undecided (the plane touches the surface there) end up in the bound.
//
// Faces in the plane itself count as above it: the area is the limit from below.
//
// Laws (tests in tests/volume/section_test.cpp):
//  (1) closed forms: boxes, spheres, cylinders, tori, in any pose; (2) refinement: inserting knots
//  changes nothing; (3) both sides: the plane (-n, -h) gives the same where no face lies in it;
//  (4) Cavalieri: the integral of the area over h is the volume; (5) |area - true| <= bound in all
//  tested models (an estimate).
#pragma once

#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/patch_model.h"

namespace isochor {

struct Section {
  Vec3 normal = Vec3::UnitZ();
  double height = 0.0;
  double area = 0.0;  // length^2
  double bound = 0.0;
  Vec3 centroid = Vec3::Zero();  // in the plane; the middle of the model when the area vanishes
  double centroid_bound = 0.0;   // of its distance; infinite when the area may vanish
  bool coplanar = false;         // a face, or a part of one, lies in the plane
};

// The section of a closed model by {x : normal.x = height}, in the length units of the given
// normal, which need not have length one. PreconditionError when the normal is zero or not finite.
Section section(const PatchModel& model, const Vec3& normal, double height);

}  // namespace isochor
