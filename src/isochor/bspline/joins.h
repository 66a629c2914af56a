// Where patches meet: finding joins, measuring them, and whether the model is closed.
//
// A side is one of the four natural sides of a patch, run in the direction of its free parameter
// ("u0", "u1" run along v). A join is a pair of sides that carry the same curve; `opposed` when
// they run against each other. A seam joins two sides of one patch. A *wrap* is a seam of an
// unclamped periodic direction: its last k pole rows are its first k rows (refinement.h).
//
// Laws:
//  (1) find_joins finds each pair of sides whose boundary points are the same (same indices or
//      ties), and nothing else;
//  (2) measures are symmetric in the two sides, and independent of the parametrisation;
//  (3) a join matches exactly when tying its poles one to one keeps the gap whatever they do; it is
//      `common` when equations between the coefficients of a common basis do.
#pragma once

#include <string>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/bspline/smoothness.h"

namespace isochor {

// "face:3 (\"top\")" or "face:3": how messages call a patch.
std::string label_of(const Patch& patch);
// "side v1 of face:3 (\"top\")".
std::string label_of(const PatchModel& model, const SideRef& side);

// How many pole rows of a direction wrap around: k when the knots are periodic with k wrapped poles
// and the first k rows are, as point classes, the last k rows; else 0.
int wrapped_rows(const Patch& patch, Direction direction, const PointClasses& classes);

// True when all boundary points of the side are one class: a pole, not an edge.
bool is_collapsed(const Patch& patch, Side side, const PointClasses& classes);

// True for the seam of a direction that wraps. Its poles do not tie boundary row to boundary row:
// row i is row i + #rows - k for i < k = wrapped_rows.
bool is_wrap(const PatchModel& model, const Join& join, const PointClasses& classes);

// All joins of sides that share their points, in the order of the patches; seams and wraps too.
// Collapsed sides have none. Three sides on one curve give three joins (see Closure::overused).
std::vector<Join> find_joins(const PatchModel& model);

// Measures the join of two given sides: matching or why not, gap, angle, curvature, smoothness.
// For sides that do not match the nearest points of the two curves are compared.
Join measure_join(const PatchModel& model, const SideRef& a, const SideRef& b, bool opposed);
// The same with other positions of the points (a certificate after an edit).
Join measure_join(const PatchModel& model, const std::vector<Vec3>& at, const SideRef& a,
                  const SideRef& b, bool opposed);
// The same with `size` in place of the model's diagonal: for patches cut out of a larger model.
Join measure_join(const PatchModel& model, double size, const SideRef& a, const SideRef& b,
                  bool opposed);
// A join that is known, measured again: in its common basis where it has one.
Join measure_join(const PatchModel& model, const std::vector<Vec3>& at, const Join& join);

// Measures parts of two sides in their common basis (common_basis.h). `common` is set when they are
// the same curve there, pole by pole within kCoincident; else `mismatch` says why not.
Join measure_common_join(const PatchModel& model, const std::vector<Vec3>& at, const SideRef& a,
                         const SidePart& part_a, const SideRef& b, const SidePart& part_b,
                         bool opposed);
// The largest distance between the two sides only, which is much cheaper.
double join_gap(const PatchModel& model, const std::vector<Vec3>& at, const Join& join);

// Whether the patches close up: each side is used exactly twice, in opposite senses.
// Collapsed sides need no partner, nor does a side that is folded onto itself. Joins of parts of
// sides count as partners of both.
struct Closure {
  bool closed = false;
  std::vector<std::string> open_sides;         // "side v1 of face:3 (\"top\")"
  std::vector<SideRef> open;                   // the same
  std::vector<std::string> overused_sides;     // joined to more than one other side
  std::vector<std::string> misoriented_sides;  // "side u0 of A and side u1 of B run the same way"
  // Length of the integral of the outward normal, divided by diagonal^2: zero for closed models,
  // a second check that does not look at the joins.
  double vector_area = 0.0;
};

// Uses model.joins, or find_joins when there are none.
Closure closure(const PatchModel& model);

}  // namespace isochor
