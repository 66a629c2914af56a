#include "isochor/edit/edit_session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/edit/edit_refinement.h"
#include "isochor/edit/edit_session_state.h"
#include "isochor/edit/follow.h"
#include "isochor/edit/prepared_edit.h"

namespace isochor {
namespace {

class Stopwatch {
 public:
  double milliseconds() const {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double, std::milli>(now - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void check_finite(const Vec3& vector, size_t move) {
  if (vector.allFinite()) return;
  std::ostringstream text;
  text << "the vector (" << vector.transpose() << ") is not finite";
  throw InputError("", "move[" + std::to_string(move) + "]", text.str());
}

// Numbers that no reader lets through, but callers may hand over.
void check_numbers(const Edit& edit) {
  for (size_t k = 0; k < edit.moves.size(); ++k) {
    check_finite(edit.moves[k].vector, k);
    for (const Vec3& step : edit.moves[k].drag) check_finite(step, k);
  }
  if (!std::isfinite(edit.volume.value)) {
    throw InputError("", "volume", std::to_string(edit.volume.value) + " is not finite");
  }
  const Vec3& direction = edit.sink.direction;
  if (edit.sink.kind == Sink::Kind::kDirection &&
      !(direction.allFinite() && direction.norm() > 0.0)) {
    throw InputError("", "sink", "the direction is zero or not finite");
  }
}

// Why trimming curves cannot move here, in words; else empty.
std::string objection_to_following(const Surroundings& surroundings, const Edit& edit) {
  if (!surroundings.measure) {
    return "\"follow\" needs a solid from a STEP, IGES or BREP file, whose trimming curves it "
           "moves";
  }
  if (!surroundings.closing.empty()) {
    return "\"follow\" works on closed solids; this one is closed by planes that the user names";
  }
  if (!std::isfinite(edit.follow.tolerance) || !(edit.follow.tolerance > 0.0)) {
    return "the tolerance of \"follow\" must be larger than zero";
  }
  return "";
}

bool has_moved(const Patch& patch, const std::vector<Vec3>& displacement) {
  return std::any_of(patch.points.begin(), patch.points.end(),
                     [&](int id) { return displacement[static_cast<size_t>(id)] != Vec3::Zero(); });
}

}  // namespace

std::vector<int> moved_points(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  std::vector<int> moved;
  for (size_t i = 0; i < to.size(); ++i) {
    if (to[i] != from[i]) moved.push_back(static_cast<int>(i));
  }
  return moved;
}

EditSession::EditSession(PatchModel model, Surroundings surroundings)
    : state_(std::make_unique<State>()) {
  validate(model);
  state_->surroundings = std::move(surroundings);
  const FluxField field = require_field(state_->surroundings.closing);
  const Bounded patches = VolumeForm(model, 1, field).bounded_value(model.points);
  state_->now.reference = patches.value + state_->surroundings.outside_volume;
  state_->patches_bound = patches.bound;
  state_->now.moved_patches.resize(model.patches.size());
  state_->now.model = std::move(model);
}

EditSession::~EditSession() = default;
EditSession::EditSession(EditSession&&) noexcept = default;
EditSession& EditSession::operator=(EditSession&&) noexcept = default;

const PatchModel& EditSession::model() const { return state_->now.model; }

const PatchModel& EditSession::candidate() const {
  return state_->active ? state_->active->candidate.model : state_->now.model;
}

const std::vector<bool>& EditSession::moved_patches() const { return state_->now.moved_patches; }

double EditSession::volume() const { return state_->total(); }

Certificate EditSession::begin(const Edit& edit) {
  State& state = *state_;
  ISOCHOR_REQUIRE(!state.active, "an edit is under way");
  check_numbers(edit);
  const bool needs_volume = edit.volume.kind != VolumeGoal::Kind::kFree;
  if (!state.surroundings.closed && needs_volume && !edit.open) {
    return state.refusal(edit, "the model is open (" + state.surroundings.why_open +
                                   "), so it encloses no volume: close it, or write \"open\": "
                                   "true to keep the integral of z dx dy, or \"volume\": \"free\"");
  }
  if (edit.method == Method::kAxis && edit.sink.kind == Sink::Kind::kDirection) {
    return state.refusal(edit, "a sink along a direction needs the method \"isotropic\"");
  }
  if (edit.method == Method::kAxis) {
    for (size_t k = 0; k < edit.holds.size(); ++k) {
      const Hold::Kind kind = edit.holds[k].kind;
      if (kind != Hold::Kind::kNormal && kind != Hold::Kind::kPlane) continue;
      const std::string name = kind == Hold::Kind::kNormal ? ".normal" : ".plane";
      return state.refusal(edit, "hold[" + std::to_string(k) + "]" + name +
                                     " couples the axes, which the method \"axis\" takes one by "
                                     "one: use \"isotropic\"");
    }
  }
  if (edit.moves.empty() && (!needs_volume || edit.volume.kind == VolumeGoal::Kind::kKeep)) {
    return state.refusal(edit, "the edit moves nothing and asks for no other volume");
  }
  const Stopwatch watch;
  Edit first = edit;  // with followers, the volume comes after them
  if (edit.follow.any()) {
    const std::string objection = objection_to_following(state.surroundings, edit);
    if (!objection.empty()) return state.refusal(edit, objection);
    first.volume = {VolumeGoal::Kind::kFree, 0.0};
  }
  PatchModel rest = refined_for(
      edit.follow.any() ? with_released_trims(state.now.model, edit.follow) : state.now.model,
      first);
  auto prepared =
      std::make_unique<PreparedEdit>(std::move(rest), first, state.surroundings.closing);
  state.active.emplace(State::Active{edit, std::move(prepared), state.now, {}, 0.0});
  state.active->prepare_ms = watch.milliseconds();
  std::vector<Vec3> values;
  for (const Move& move : edit.moves) values.push_back(move.vector);
  return drag(values);
}

Certificate EditSession::drag(const std::vector<Vec3>& values) {
  ISOCHOR_REQUIRE(state_->active.has_value(), "no edit is under way");
  const size_t moves = state_->active->edit.moves.size();
  ISOCHOR_REQUIRE(values.size() == moves, values.size(), moves);
  for (size_t k = 0; k < moves; ++k) check_finite(values[k], k);
  state_->solve(values);
  return state_->active->certificate;
}

void EditSession::State::solve(const std::vector<Vec3>& values) {
  const Stopwatch watch;
  const double wanted = wanted_change(active->edit.volume);
  Certificate certificate;
  active->prepared->describe(certificate);
  certificate.resolved = active->edit;
  certificate.volume.before = total();
  certificate.volume.wanted_change = wanted;
  active->certificate = std::move(certificate);
  active->candidate = now;
  if (active->certificate.coefficients == 0) {
    active->certificate.outcome = Outcome::kInfeasible;
    active->certificate.reason =
        "the extent holds no free coefficient" +
        std::string(active->certificate.locked.empty()
                        ? ""
                        : ": " + active->certificate.locked.front().reason) +
        "; enlarge the extent, or let \"refine\": \"auto\" insert knots";
    active->certificate.volume.after = total();
    return;
  }
  const double scale = scale_of(std::max(std::abs(total()), std::abs(total() + wanted)));
  const SolveResult result = active->prepared->solve_for(values, wanted, scale);
  active->certificate.timings_ms["solve"] = watch.milliseconds();
  active->certificate.timings_ms["prepare"] = active->prepare_ms;
  fill(result, values);
}

void EditSession::State::fill(const SolveResult& result, const std::vector<Vec3>& values) {
  Certificate& certificate = active->certificate;
  certificate.outcome = result.outcome;
  certificate.reason = result.reason;
  certificate.conflicting = result.culprits;
  certificate.conflicts = result.conflicts;
  certificate.redundant = result.redundant;
  certificate.rows = result.rows;
  certificate.rank = result.rank;
  const bool free = active->edit.volume.kind == VolumeGoal::Kind::kFree;
  certificate.freedom_left = std::max(0, result.freedom_left - (free ? 0 : 1));
  certificate.iterations = result.iterations;
  certificate.stationarity = result.stationarity;
  certificate.volume.after = total();
  if (result.outcome != Outcome::kDone) return;

  certificate.energy_before = result.positional_energy;
  certificate.energy_after = result.energy;
  certificate.skin.residual = result.kept_residual;
  const std::vector<Vec3> points = active->prepared->displaced(result.delta);
  if (active->edit.follow.any()) return finish_followed(points, values, result.delta);
  const PatchModel& rest = active->prepared->rest();
  PatchModel after = rest;
  after.points = points;
  fill_places(after, values, result.delta);
  const SkinMeasures skin =
      active->prepared->measure_skin(after.points, fill_motion(rest.patches, rest.points, points));
  certificate.joins = skin.joins;
  certificate.skin.change = skin.change;
  fill_volume(rest, std::move(after), moved_points(rest.points, points));
}

std::vector<bool> EditSession::State::fill_motion(const std::vector<Patch>& patches,
                                                  const std::vector<Vec3>& from,
                                                  const std::vector<Vec3>& to) {
  Certificate& certificate = active->certificate;
  std::vector<Vec3> displacement(to.size());
  for (size_t i = 0; i < displacement.size(); ++i) {
    displacement[i] = to[i] - from[i];
    certificate.max_distance = std::max(certificate.max_distance, displacement[i].norm());
  }
  certificate.poles_moved = static_cast<int>(moved_points(from, to).size());
  std::vector<bool> moved(patches.size(), false);
  for (size_t q = 0; q < patches.size(); ++q) {
    if (!has_moved(patches[q], displacement)) continue;
    ++certificate.patches_moved;
    moved[q] = true;
    active->candidate.moved_patches[q] = true;
  }
  return moved;
}

void EditSession::State::fill_volume(const PatchModel& rest, PatchModel after,
                                     const std::vector<int>& moved) {
  const VolumeForm& form = active->prepared->volume_form();
  // Of the points as they come out, rounded: more precise than what the solution aimed at.
  const Bounded change = form.bounded_change(rest.points, after.points, form.support_of(moved));
  take_volume(change, std::move(after));
}

void EditSession::State::take_volume(const Bounded& change, PatchModel after) {
  const bool free = active->edit.volume.kind == VolumeGoal::Kind::kFree;
  VolumeRecord& volume = active->certificate.volume;
  volume.after = volume.before + change.value;
  volume.relative_change = change.value / scale_of(volume.before);
  volume.total_bound = surroundings.outside_bound + patches_bound;
  // Relative to the volume before as it is recorded; the quotient is rounded.
  volume.bound = change.bound / scale_of(volume.before) +
                 4.0 * kUnitRoundoff * std::abs(volume.relative_change);
  const double missed = std::abs(change.value - volume.wanted_change);
  volume.kept =
      !free && active->edit.method != Method::kTaylor &&
      missed <= kVolumeKept * scale_of(std::max(std::abs(volume.before), std::abs(volume.after)));

  active->candidate.model = std::move(after);
  if (free || active->edit.volume.kind == VolumeGoal::Kind::kKeep) {
    active->candidate.excess = now.excess + change.value;
  } else {
    active->candidate.reference = total() + volume.wanted_change;
    active->candidate.excess = change.value - volume.wanted_change;
  }
}

void EditSession::State::fill_places(const PatchModel& after, const std::vector<Vec3>& values,
                                     const std::vector<Vec3>& delta) {
  const PreparedEdit& prepared = *active->prepared;
  const auto record_of = [&](const ResolvedPlace& place, const Vec3& asked) {
    MoveRecord record;
    record.place = place.text;
    record.from = place.position;
    record.asked = asked;
    if (place.coefficient) {
      for (size_t k = 0; k < place.row.coefficient.size(); ++k) {
        record.got +=
            place.row.value[k].cwiseProduct(delta[static_cast<size_t>(place.row.coefficient[k])]);
      }
    } else {
      record.got = after.surface(place.patch).point(place.uv.u, place.uv.v) - place.position;
    }
    record.error = (record.got - asked).norm();
    return record;
  };
  for (size_t k = 0; k < prepared.moves().size(); ++k) {
    active->certificate.moves.push_back(
        record_of(prepared.moves()[k], prepared.displacement(k, values[k])));
  }
  for (const ResolvedPlace& hold : prepared.holds()) {
    active->certificate.holds.push_back(record_of(hold, Vec3::Zero()));
  }
}

Certificate EditSession::commit() {
  State& state = *state_;
  ISOCHOR_REQUIRE(state.active.has_value(), "no edit is under way");
  ISOCHOR_REQUIRE(state.active->certificate.outcome == Outcome::kDone, "the edit was not done");
  state.undo.push_back(std::move(state.now));
  state.redo.clear();
  state.now = std::move(state.active->candidate);
  Certificate certificate = std::move(state.active->certificate);
  state.active.reset();
  return certificate;
}

void EditSession::cancel() { state_->active.reset(); }

bool EditSession::undo() {
  State& state = *state_;
  ISOCHOR_REQUIRE(!state.active, "an edit is under way");
  if (state.undo.empty()) return false;
  state.redo.push_back(std::exchange(state.now, std::move(state.undo.back())));
  state.undo.pop_back();
  return true;
}

bool EditSession::redo() {
  State& state = *state_;
  ISOCHOR_REQUIRE(!state.active, "an edit is under way");
  if (state.redo.empty()) return false;
  state.undo.push_back(std::exchange(state.now, std::move(state.redo.back())));
  state.redo.pop_back();
  return true;
}

Certificate EditSession::apply(const Edit& edit, const CancelToken& token) {
  Certificate certificate = begin(edit);
  if (!state_->active) return certificate;  // refused before it began
  size_t steps = 0;
  for (const Move& move : edit.moves) steps = std::max(steps, move.drag.size());
  for (size_t step = 0; step < steps && !token.cancelled(); ++step) {
    std::vector<Vec3> values;
    for (const Move& move : edit.moves) {
      values.push_back(move.drag.empty() ? move.vector
                                         : move.drag[std::min(step, move.drag.size() - 1)]);
    }
    certificate = drag(values);
  }
  if (token.cancelled()) {
    certificate.outcome = Outcome::kCancelled;
    certificate.reason = "cancelled by the user";
  }
  if (certificate.outcome == Outcome::kDone) return commit();
  cancel();
  return certificate;
}

}  // namespace isochor
