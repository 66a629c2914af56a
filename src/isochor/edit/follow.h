// Faces that follow a moved trimming curve.
//
// Symbols: F, a patch that an edit has moved by D_F; G, the follower; they share a trimming curve
// whose parameter curves c_F(t), c_G(t) stay. G's displacement D_G is to satisfy
// D_G(c_G(t)) = D_F(c_F(t)). That has no exact solution in a spline space, so D_G is the least
// squares fit at many places t (the patches' `along`), damped by the roughness of D_G; then
// the spans that miss by more than a quarter of the tolerance are halved, until none does.
//
// The energy is that of the displacement, so the details of G survive (Boier-Martin, Ronfard,
// Bernardini 2005).
//
// Laws:
//  (1) only poles of followers move, and none that a lock or a tie to another patch holds;
//  (2) the equations that keep G smooth (kept rows) hold as in any edit;
//  (3) no pole of a follower moves more than twice as far as the curve;
//  (4) the deviation is measured at all places after the fit; more than the tolerance is a refusal.
#pragma once

#include <string>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/edit/certificate.h"
#include "isochor/edit/edit_script.h"

namespace isochor {

// The model with the trimming curves between followers and other patches released for the others,
// and its locks.
// Throws InputError for names that do not exist, and where a face cannot follow: it shares no
// trimming curve with another patch, or meets it smoothly there.
PatchModel with_released_trims(const PatchModel& model, const Follow& follow);

// The opposite: all trimming curves locked again.
PatchModel with_locked_trims(PatchModel model);

struct Followed {
  std::string refusal;       // when it cannot be done: why, in words
  PatchModel rest;           // `before`, in the basis that was needed
  std::vector<Vec3> points;  // of rest, where they are now
  std::vector<FollowRecord> records;
};

// `before`: with released trims; `points`: its points after the edit. `continuity`: what the
// followers keep at their joins. Cost: a sparse factorisation of the follower's poles per round.
Followed make_follow(const PatchModel& before, const std::vector<Vec3>& points,
                     const Follow& follow, Continuity continuity);

}  // namespace isochor
