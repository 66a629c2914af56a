// The second half of an edit that moves trimming curves.
#include <algorithm>
#include <utility>

#include "isochor/edit/edit_session_state.h"
#include "isochor/edit/follow.h"

namespace isochor {

SolveResult EditSession::State::restore_volume(PatchModel& model, double change,
                                               Bounded& achieved) const {
  Edit edit = active->edit;
  edit.follow = {};
  edit.refine = {};
  edit.volume = {VolumeGoal::Kind::kChange, change};
  std::vector<Vec3> still;
  for (size_t k = 0; k < edit.moves.size(); ++k) {
    const ResolvedPlace& place = active->prepared->moves()[k];
    Move& move = edit.moves[k];
    move.relative = true;
    move.vector = Vec3::Zero();
    if (!place.coefficient) {
      move.place.kind = Place::Kind::kSurface;
      move.place.patch = model.patches[static_cast<size_t>(place.patch)].handle;
      move.place.uv = place.uv;
      move.place.normalised = false;
    }
    still.push_back(move.vector);
  }
  PreparedEdit prepared(model, edit, surroundings.closing);
  SolveResult result = prepared.solve_for(still, change, scale_of(total()));
  if (result.outcome != Outcome::kDone) return result;
  const std::vector<Vec3> points = prepared.displaced(result.delta);
  const VolumeForm& form = prepared.volume_form();
  achieved = form.bounded_change(model.points, points,
                                 form.support_of(moved_points(model.points, points)));
  model.points = points;
  return result;
}

void EditSession::State::finish_followed(const std::vector<Vec3>& points,
                                         const std::vector<Vec3>& values,
                                         const std::vector<Vec3>& delta) {
  Certificate& certificate = active->certificate;
  const Edit& edit = active->edit;
  const auto fail = [&](Outcome outcome, const std::string& reason) {
    certificate.outcome = outcome;
    certificate.reason = reason;
    active->candidate = now;
  };
  Followed followed = make_follow(active->prepared->rest(), points, edit.follow, edit.continuity);
  certificate.followers = followed.records;
  if (!followed.refusal.empty()) return fail(Outcome::kInfeasible, followed.refusal);
  PatchModel after = followed.rest;
  after.points = followed.points;
  after = with_locked_trims(std::move(after));
  std::vector<bool> moved = fill_motion(after.patches, followed.rest.points, after.points);
  for (size_t q = 0; q < moved.size(); ++q) moved[q] = moved[q] || now.moved_patches[q];
  // Trims that earlier edits moved may have parted by as much as those allowed.
  const double tolerance = std::max(now.trim_tolerance, edit.follow.tolerance);
  const MeasuredVolume measured = surroundings.measure(after, moved, tolerance);
  if (!measured.refusal.empty()) return fail(Outcome::kRefused, measured.refusal);
  certificate.volume_of_followers = measured.volume.value - total();
  Bounded change{certificate.volume_of_followers, measured.volume.bound};
  const bool free = edit.volume.kind == VolumeGoal::Kind::kFree;
  if (!free) {
    Bounded restored;
    const SolveResult result = restore_volume(
        after, certificate.volume.wanted_change - certificate.volume_of_followers, restored);
    if (result.outcome != Outcome::kDone) {
      certificate.conflicting = result.culprits;
      return fail(result.outcome,
                  "the faces follow, but the extent cannot make up for the volume away from the "
                  "moved trimming curves: " +
                      result.reason);
    }
    change.value += restored.value;
    change.bound += restored.bound;
  }
  certificate.max_distance = 0.0;
  certificate.patches_moved = 0;
  moved = fill_motion(after.patches, followed.rest.points, after.points);
  fill_places(after, values, delta);
  const SkinMeasures skin = SkinGauge(followed.rest).measure(after.points, moved);
  certificate.joins = skin.joins;
  certificate.skin.change = skin.change;
  take_volume(change, std::move(after));
  active->candidate.trim_tolerance = tolerance;
}

}  // namespace isochor
