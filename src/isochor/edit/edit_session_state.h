// What an editing session remembers. Internal to `edit`.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isochor/base/tolerance.h"
#include "isochor/edit/edit_session.h"
#include "isochor/edit/prepared_edit.h"

namespace isochor {

// The points that differ.
std::vector<int> moved_points(const std::vector<Vec3>& from, const std::vector<Vec3>& to);

struct EditSession::State {
  // Everything that an undo brings back.
  struct Snapshot {
    PatchModel model;
    double reference = 0.0;  // the volume that "keep" means
    double excess = 0.0;     // the model's volume minus the reference, from exact changes
    std::vector<bool> moved_patches;
    double trim_tolerance = 0.0;  // how far faces may have parted at the trims moved so far
  };
  struct Active {
    Edit edit;
    std::unique_ptr<PreparedEdit> prepared;
    Snapshot candidate;
    Certificate certificate;
    double prepare_ms = 0.0;
  };

  Snapshot now;
  Surroundings surroundings;
  double patches_bound = 0.0;  // of the volume at the start
  std::vector<Snapshot> undo, redo;
  std::optional<Active> active;

  double total() const { return now.reference + now.excess; }
  // What changes of the volume are compared with: the volume, or the cube of the diagonal where the
  // volume is no more than rounding of that (an open sheet that straddles z = 0).
  double scale_of(double volume) const {
    const double cube = std::pow(diagonal(now.model), 3);
    return std::abs(volume) > kVolumeKept * cube ? std::abs(volume) : cube;
  }

  // The change that the goal asks for, from the present volume.
  double wanted_change(const VolumeGoal& goal) const {
    switch (goal.kind) {
      case VolumeGoal::Kind::kKeep:
        return -now.excess;
      case VolumeGoal::Kind::kFree:
        return 0.0;
      case VolumeGoal::Kind::kTarget:
        return (goal.value - now.reference) - now.excess;
      case VolumeGoal::Kind::kFactor:
        return (goal.value - 1.0) * total();
      case VolumeGoal::Kind::kChange:
        return goal.value;
    }
    return 0.0;
  }

  Certificate refusal(const Edit& edit, std::string reason) const {
    Certificate certificate;
    certificate.name = edit.name;
    certificate.resolved = edit;
    certificate.outcome = Outcome::kRefused;
    certificate.reason = std::move(reason);
    certificate.volume.before = certificate.volume.after = total();
    return certificate;
  }

  void solve(const std::vector<Vec3>& values);
  void fill(const SolveResult& result, const std::vector<Vec3>& values);
  // Records what moved; the patches that did.
  std::vector<bool> fill_motion(const std::vector<Patch>& patches, const std::vector<Vec3>& from,
                                const std::vector<Vec3>& to);
  // The second half of an edit with followers: they follow the points, and an edit away from the
  // trims makes up for the volume.
  void finish_followed(const std::vector<Vec3>& points, const std::vector<Vec3>& values,
                       const std::vector<Vec3>& delta);
  // Moves the volume of `model` by `change` with the places of the edit held.
  SolveResult restore_volume(PatchModel& model, double change, Bounded& achieved) const;
  // `after` becomes the candidate; `moved`: its points that have moved.
  void fill_volume(const PatchModel& rest, PatchModel after, const std::vector<int>& moved);
  // The same for a change that is known.
  void take_volume(const Bounded& change, PatchModel after);
  void fill_places(const PatchModel& after, const std::vector<Vec3>& values,
                   const std::vector<Vec3>& delta);
};

}  // namespace isochor
