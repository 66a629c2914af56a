// What one edit did, in numbers: the material of the report (CONTRACT, "Report").
#pragma once

#include <map>
#include <string>
#include <vector>

#include "isochor/base/outcome.h"
#include "isochor/base/vec3.h"
#include "isochor/edit/edit_script.h"
#include "isochor/edit/named_conflict.h"
#include "isochor/edit/skin_change.h"

namespace isochor {

struct VolumeRecord {
  double before = 0.0, after = 0.0;
  // (after - before) / |before|, from the exact change of the patches; over the cube of the
  // diagonal for open models whose volume is zero up to rounding.
  double relative_change = 0.0;
  double bound = 0.0;          // of relative_change: rounding (and quadrature for rational patches)
  double total_bound = 0.0;    // of `before` itself, when it includes trimmed faces
  double wanted_change = 0.0;  // what was asked of this edit
  bool kept = false;           // the goal was met within kVolumeKept; never true for taylor
};

struct MoveRecord {
  std::string place;  // "face:3 (\"skin\") at uv (0.5, 0.25)"
  Vec3 from = Vec3::Zero();
  Vec3 asked = Vec3::Zero();  // displacement
  Vec3 got = Vec3::Zero();
  double error = 0.0;
};

// The equations that hold the skin together, and what became of it.
struct SkinRecord {
  int relations = 0;      // joins, knot lines and poles whose smoothness equations keep
  double residual = 0.0;  // of those equations at the displacement, in doubles; a length
  SkinChange change;      // measured on what was written
};

struct LockRecord {
  std::string patch;
  std::string reason;
  int coefficients = 0;
};

// The face of an edit that followed another one across a trimming curve.
struct FollowRecord {
  std::string patch;
  double deviation = 0.0;  // from the face it follows, largest of many places along the curve
  double max_distance = 0.0;
  int poles_before = 0, poles_after = 0;  // refined until the deviation was small enough
};

// One edit, done or not.
struct Certificate {
  std::string name;
  Outcome outcome = Outcome::kDone;
  std::string reason;
  std::vector<std::string> conflicting;  // constraints to blame
  std::vector<NamedConflict> conflicts;  // when they contradict each other: the proofs
  std::vector<std::string> redundant;
  VolumeRecord volume;
  std::vector<MoveRecord> moves;
  std::vector<MoveRecord> holds;
  std::vector<FollowRecord> followers;
  double volume_of_followers = 0.0;  // change of volume by what moved with the trims, made up for
  JoinRecord joins;
  SkinRecord skin;
  int rows = 0, rank = 0, freedom_left = 0;
  int coefficients = 0;  // free in the extent
  int poles_moved = 0;
  int patches_moved = 0;
  double max_distance = 0.0;
  std::vector<LockRecord> locked;
  double energy_before = 0.0, energy_after = 0.0;  // of the displacement: moves alone, with volume
  int iterations = 0;
  double stationarity = 0.0;
  std::map<std::string, double> timings_ms;
  Edit resolved;  // with every default that was used
};

}  // namespace isochor
