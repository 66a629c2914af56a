#include "isochor/edit/prepared_edit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/edit/extent_selection.h"
#include "isochor/edit/mirrored_model.h"
#include "isochor/edit/names.h"
#include "isochor/edit/places.h"

namespace isochor {
namespace {

// The mirror plane among the closing planes, as an axis; -1: none.
int mirror_axis(const std::vector<ClosingPlane>& closing) {
  int found = -1;
  for (const ClosingPlane& plane : closing) {
    if (!plane.mirror) continue;
    if (found >= 0) {
      throw InputError("", "close", "one mirror plane is supported; give the others as planes");
    }
    plane.normal.maxCoeff(&found);
    if (plane.normal != Vec3::Unit(found) || plane.offset != 0.0) {
      throw InputError("", "close", "a mirror plane must be x = 0, y = 0 or z = 0");
    }
  }
  return found;
}

std::vector<int> symmetry_axes(const Edit& edit, int mirror) {
  std::vector<int> axes;
  if (mirror >= 0) axes.push_back(mirror);
  for (const Hold& hold : edit.holds) {
    if (hold.kind == Hold::Kind::kSymmetry && hold.axis != mirror) axes.push_back(hold.axis);
  }
  if (axes.size() > 1) {
    throw InputError("", "hold",
                     "one plane of symmetry per edit is supported, " + std::to_string(axes.size()) +
                         " were given");
  }
  return axes;
}

// The same points without the patches of the mirror image.
PatchModel first_patches(PatchModel whole, const PatchModel& rest) {
  const auto images = static_cast<std::ptrdiff_t>(rest.patches.size());
  whole.patches.erase(whole.patches.begin() + images, whole.patches.end());
  return whole;
}

// For the model and, when there is one, its mirror image.
std::vector<DisplacementSpace::EdgeRule> edges_of(const PatchModel& model, const Edit& edit,
                                                  bool mirrored) {
  std::vector<DisplacementSpace::EdgeRule> rules;
  const int images = static_cast<int>(model.patches.size());
  for (size_t k = 0; k < edit.edge_continuity.size(); ++k) {
    const EdgeContinuity& item = edit.edge_continuity[k];
    const int a = find_patch(model, item.edge[0]);
    const int b = find_patch(model, item.edge[1]);
    const bool found = std::any_of(model.joins.begin(), model.joins.end(), [&](const Join& join) {
      return (join.a.patch == a && join.b.patch == b) || (join.a.patch == b && join.b.patch == a);
    });
    if (!found) {
      throw InputError("", "continuity.edges[" + std::to_string(k) + "]",
                       "\"" + item.edge[0] + "\" and \"" + item.edge[1] + "\" share no edge");
    }
    rules.push_back({a, b, item.keep});
    if (mirrored) rules.push_back({a + images, b + images, item.keep});
  }
  return rules;
}

}  // namespace

PreparedEdit::PreparedEdit(PatchModel rest, const Edit& edit,
                           const std::vector<ClosingPlane>& closing)
    : rest_(std::move(rest)),
      closing_(closing),
      whole_(mirror_axis(closing) < 0 ? rest_ : mirrored_model(rest_, mirror_axis(closing))),
      edit_(edit),
      volume_(rest_, 1, require_field(closing)),
      whole_volume_(first_patches(whole_, rest_), 1, require_field(closing)),
      space_(whole_, {edit.scale, edit.continuity, symmetry_axes(edit, mirror_axis(closing)),
                      edges_of(rest_, edit, mirror_axis(closing) >= 0)}),
      size_(diagonal(rest_)) {
  for (size_t k = 0; k < edit.moves.size(); ++k) {
    const std::string where = "move[" + std::to_string(k) + "]";
    moves_.push_back(resolve(edit.moves[k].place, where));
    if (moves_.back().coefficient && !edit.moves[k].relative &&
        edit.scale.kind != Scale::Kind::kFinest) {
      throw InputError("", where,
                       "a coefficient of a coarser scale has no position of its own: use \"by\"");
    }
  }
  resolve_holds();
  for (const ClosingPlane& plane : closing_) {
    if (!plane.mirror) hold_closing_plane(plane);  // a mirror plane is held by symmetry
  }
  select_coefficients();
}

ResolvedPlace PreparedEdit::resolve(const Place& place, const std::string& where) const {
  if (place.kind == Place::Kind::kCoefficient) return resolve_coefficient(place, where);
  const auto [patch, uv] = surface_place(rest_, place, where);
  ResolvedPlace resolved;
  resolved.patch = patch;
  resolved.uv = uv;
  resolved.row = space_.surface_row(rest_, patch, uv);
  resolved.position = rest_.surface(patch).point(uv.u, uv.v);
  resolved.text = label_of(rest_.patches[static_cast<size_t>(patch)]) + " at uv " + text_of(uv);
  return resolved;
}

ResolvedPlace PreparedEdit::resolve_coefficient(const Place& place,
                                                const std::string& where) const {
  ResolvedPlace resolved;
  resolved.patch = find_patch(rest_, place.patch);
  resolved.coefficient = true;
  const Patch& patch = rest_.patches[static_cast<size_t>(resolved.patch)];
  const int nu = space_.u_knots(resolved.patch).size();
  const int nv = space_.v_knots(resolved.patch).size();
  if (place.i < 0 || place.j < 0 || place.i >= nu || place.j >= nv) {
    throw InputError("", where,
                     "pole [" + std::to_string(place.i) + ", " + std::to_string(place.j) +
                         "] is outside the grid of " + std::to_string(nu) + " x " +
                         std::to_string(nv) + " coefficients of the chosen scale");
  }
  resolved.row = space_.grid_row(resolved.patch, place.i, place.j);
  const bool finest = patch.u_size() == nu && patch.v_size() == nv;
  resolved.position = finest ? rest_.points[static_cast<size_t>(patch.point(place.i, place.j))]
                             : space_.place(resolved.row.coefficient.front());
  resolved.text =
      label_of(patch) + " pole [" + std::to_string(place.i) + ", " + std::to_string(place.j) + "]";
  return resolved;
}

void PreparedEdit::select_coefficients() {
  std::vector<ExtentSeed> seeds;
  for (const ResolvedPlace& move : moves_) {
    seeds.push_back({move.position, move.row.coefficient});
    for (int axis : symmetry_axes(
             edit_, mirror_axis(closing_))) {  // a coefficient has its place on either side
      Vec3 image = move.position;
      image[axis] = -image[axis];
      seeds.push_back({image, move.row.coefficient});
    }
  }
  extent_ = select_extent(whole_, space_, edit_.extent, seeds);
  sink_ = edit_.sink.kind == Sink::Kind::kOtherExtent
              ? select_extent(whole_, space_, edit_.sink.extent, seeds)
              : extent_;
}

Vec3 PreparedEdit::displacement(size_t k, const Vec3& value) const {
  return edit_.moves[k].relative ? value : Vec3(value - moves_[k].position);
}

void PreparedEdit::make_solver() {
  SolveProblem problem;
  problem.space = &space_;
  problem.volume = &whole_volume_;
  problem.points = &whole_.points;
  problem.extent = extent_;
  problem.sink = sink_;
  if (edit_.sink.kind == Sink::Kind::kDirection) problem.sink_direction = edit_.sink.direction;
  for (size_t k = 0; k < moves_.size(); ++k) {
    problem.constraints.push_back(
        {"move[" + std::to_string(k) + "]", moves_[k].row, displacement(k, edit_.moves[k].vector)});
  }
  for (size_t k = 0; k < holds_.size(); ++k) {
    problem.constraints.push_back({hold_names_[k], holds_[k].row, Vec3::Zero()});
  }
  problem.constraints.insert(problem.constraints.end(), normals_.begin(), normals_.end());
  for (const KeptRow& kept : space_.kept_rows()) {
    problem.kept.push_back({space_.kept_name(kept), kept.row});
  }
  problem.kept.insert(problem.kept.end(), kept_.begin(), kept_.end());
  problem.volume_free = edit_.volume.kind == VolumeGoal::Kind::kFree;
  problem.size = size_;
  problem.method = edit_.method;
  problem.axis_order = edit_.axis_order;
  solver_ = std::make_unique<EditSolver>(std::move(problem));
}

SolveResult PreparedEdit::solve_for(const std::vector<Vec3>& values, double wanted_change,
                                    double volume_scale) {
  ISOCHOR_REQUIRE(values.size() == moves_.size(), values.size(), moves_.size());
  if (!solver_) make_solver();
  std::vector<Vec3> right_sides;
  for (size_t k = 0; k < moves_.size(); ++k) right_sides.push_back(displacement(k, values[k]));
  right_sides.resize(moves_.size() + holds_.size() + normals_.size(), Vec3::Zero());
  SolveResult result = solver_->solve(right_sides, wanted_change, volume_scale);
  if (result.outcome == Outcome::kInfeasible) {
    // What cannot move may be held by a wish of the user's.
    const std::vector<std::string> culprits = result.culprits;
    for (size_t k = 0; k < moves_.size(); ++k) {
      const std::string name = "move[" + std::to_string(k) + "]";
      if (std::find(culprits.begin(), culprits.end(), name) == culprits.end()) continue;
      for (const std::string& hold : holds_that_lock(moves_[k].row)) {
        auto& all = result.culprits;
        if (std::find(all.begin(), all.end(), hold) == all.end()) all.push_back(hold);
      }
    }
  }
  return result;
}

// The edge and symmetry holds that lock coefficients of a row.
std::vector<std::string> PreparedEdit::holds_that_lock(const CoefficientRow& row) const {
  std::vector<std::string> names;
  for (size_t k = 0; k < edit_.holds.size(); ++k) {
    const Hold& hold = edit_.holds[k];
    const bool symmetry = hold.kind == Hold::Kind::kSymmetry;
    if (!symmetry && hold.kind != Hold::Kind::kEdge) continue;
    const std::string name = "hold[" + std::to_string(k) + (symmetry ? "].symmetry" : "].edge");
    const std::string reason = name + internal::kKeepsTheEdge;
    bool locks = symmetry;
    for (size_t i = 0; i < row.coefficient.size(); ++i) {
      const int c = row.coefficient[i];
      if (symmetry) {  // mirrored halves cancel across the plane, or are locked on it
        const bool free = !(space_.locked_axes(c) >> hold.axis & 1u);
        locks = locks && !(free && row.value[i][hold.axis] != 0.0);
      } else {
        locks = locks || space_.lock_reason(c) == reason;
      }
    }
    if (locks) names.push_back(name);
  }
  return names;
}

std::vector<Vec3> PreparedEdit::displaced(const std::vector<Vec3>& delta) const {
  std::vector<Vec3> points = space_.expand(delta);
  points.resize(rest_.points.size());
  for (size_t i = 0; i < points.size(); ++i) points[i] += rest_.points[i];
  return points;
}

SkinMeasures PreparedEdit::measure_skin(const std::vector<Vec3>& points,
                                        const std::vector<bool>& moved) {
  if (!gauge_) gauge_.emplace(rest_);
  return gauge_->measure(points, moved);
}

void PreparedEdit::describe(Certificate& certificate) const {
  certificate.name = edit_.name;
  certificate.resolved = edit_;
  std::set<int> relations;
  for (const KeptRow& kept : space_.kept_rows()) {
    const bool touched = std::any_of(
        kept.row.coefficient.begin(), kept.row.coefficient.end(),
        [&](int c) { return extent_[static_cast<size_t>(c)] || sink_[static_cast<size_t>(c)]; });
    const SmoothRelation& relation = space_.relations()[static_cast<size_t>(kept.relation)];
    if (touched && relation.order > 0) relations.insert(kept.relation);
  }
  certificate.skin.relations = static_cast<int>(relations.size());
  std::map<std::pair<std::string, std::string>, int> locked;
  for (int c = 0; c < space_.size(); ++c) {
    const auto at = static_cast<size_t>(c);
    if (!extent_[at] && !sink_[at]) continue;
    if (space_.locked_axes(c) != 7) {
      ++certificate.coefficients;
    } else {
      const Patch& patch = whole_.patches[static_cast<size_t>(space_.patch_of(c))];
      ++locked[{label_of(patch), space_.lock_reason(c)}];
    }
  }
  for (const auto& [key, count] : locked) {
    certificate.locked.push_back({key.first, key.second, count});
  }
}

}  // namespace isochor
