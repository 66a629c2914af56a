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
#include "isochor/edit/names.h"
#include "isochor/edit/places.h"

namespace isochor {
namespace {

std::vector<int> symmetry_axes(const Edit& edit) {
  std::vector<int> axes;
  for (const Hold& hold : edit.holds) {
    if (hold.kind == Hold::Kind::kSymmetry) axes.push_back(hold.axis);
  }
  if (axes.size() > 1) {
    throw InputError("", "hold",
                     "one plane of symmetry per edit is supported, " + std::to_string(axes.size()) +
                         " were given");
  }
  return axes;
}

constexpr const char* kKeepsTheEdge = " keeps the edge";

// A row as its values and coefficients, to find equal ones.
using CoefficientSet = std::vector<std::pair<int, double>>;

// The form n . (row), exactly for the doubles of n.
CoefficientRow along(CoefficientRow row, const Vec3& normal) {
  for (size_t k = 0; k < row.coefficient.size(); ++k) {
    for (int a = 0; a < 3; ++a) {
      Rational& value = row.exact[k][static_cast<size_t>(a)];
      value *= Rational(normal[a]);
      row.value[k][a] = value.to_double();
    }
  }
  return row;
}

std::vector<DisplacementSpace::EdgeRule> edges_of(const PatchModel& model, const Edit& edit) {
  std::vector<DisplacementSpace::EdgeRule> rules;
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
  }
  return rules;
}

}  // namespace

PreparedEdit::PreparedEdit(PatchModel rest, const Edit& edit)
    : rest_(std::move(rest)),
      edit_(edit),
      volume_(rest_),
      space_(rest_, {edit.scale, edit.continuity, symmetry_axes(edit), edges_of(rest_, edit)}),
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

void PreparedEdit::resolve_holds() {
  for (size_t k = 0; k < edit_.holds.size(); ++k) {
    const Hold& hold = edit_.holds[k];
    const std::string name = "hold[" + std::to_string(k) + "]";
    switch (hold.kind) {
      case Hold::Kind::kPlace:
        holds_.push_back(resolve(hold.place, name));
        hold_names_.push_back(name);
        break;
      case Hold::Kind::kNormal:
        hold_normal(hold.place, name + ".normal");
        break;
      case Hold::Kind::kEdge:
        lock_edge(hold, name + ".edge");
        break;
      case Hold::Kind::kPlane:
        hold_plane(hold, name + ".plane");
        break;
      case Hold::Kind::kSymmetry:
        break;  // the space has it
    }
  }
}

void PreparedEdit::lock_edge(const Hold& hold, const std::string& name) {
  const int a = find_patch(rest_, hold.edge[0]);
  const int b = find_patch(rest_, hold.edge[1]);
  std::vector<int> points;
  for (const Join& join : rest_.joins) {
    const bool same =
        (join.a.patch == a && join.b.patch == b) || (join.a.patch == b && join.b.patch == a);
    if (!same) continue;
    for (const SideRef& side : {join.a, join.b}) {
      const Patch& patch = rest_.patches[static_cast<size_t>(side.patch)];
      const KnotVector& across = is_u_side(side.side) ? patch.u_knots : patch.v_knots;
      const int rows = boundary_rows(across, is_begin_side(side.side), 0);
      for (int depth = 0; depth < rows; ++depth) {
        for (const auto& [i, j] : side_indices(patch, side.side, depth)) {
          points.push_back(patch.point(i, j));
        }
      }
    }
  }
  if (points.empty()) {
    throw InputError("", name,
                     "\"" + hold.edge[0] + "\" and \"" + hold.edge[1] +
                         "\" share no edge along which both can move");
  }
  space_.lock_points(points, name + kKeepsTheEdge);
}

// The normal n stays when the tangents' displacements have no part along it: n . delta_u = 0 and
// n . delta_v = 0, since n . S_u = n . S_v = 0 already. Linear, and exact for any displacement.
void PreparedEdit::hold_normal(const Place& place, const std::string& name) {
  const ResolvedPlace at = resolve(place, name);
  const Vec3 normal = rest_.surface(at.patch).normal(at.uv.u, at.uv.v);
  if (normal == Vec3::Zero()) {
    throw InputError("", name, at.text + " has no normal: the surface is singular there");
  }
  for (SurfaceForm form : {SurfaceForm::kAlongU, SurfaceForm::kAlongV}) {
    normals_.push_back({name, along(space_.surface_row(rest_, at.patch, at.uv, form), normal),
                        Vec3::Zero(), 7, true});
  }
}

void PreparedEdit::hold_plane(const Hold& hold, const std::string& name) {
  const Vec3 normal = hold.plane_normal.normalized();
  std::set<CoefficientSet> seen;  // tied points have one row
  bool any = false;
  for (size_t i = 0; i < rest_.points.size(); ++i) {
    const double off = normal.dot(rest_.points[i] - hold.plane_point);
    if (!(std::abs(off) <= kCoincident * size_)) continue;
    CoefficientRow row = space_.point_row(static_cast<int>(i));
    if (row.coefficient.empty()) continue;  // a point that no patch uses
    any = true;
    CoefficientSet key;
    for (size_t k = 0; k < row.coefficient.size(); ++k) {
      key.emplace_back(row.coefficient[k], row.value[k].x());
    }
    if (!seen.insert(std::move(key)).second) continue;
    kept_.push_back({name, along(std::move(row), normal), Vec3::Zero(), 7, true});
  }
  if (!any) throw InputError("", name, "no control point of the model lies in this plane");
}

void PreparedEdit::select_coefficients() {
  std::vector<ExtentSeed> seeds;
  for (const ResolvedPlace& move : moves_) {
    seeds.push_back({move.position, move.row.coefficient});
    for (int axis : symmetry_axes(edit_)) {  // a coefficient has its place on either side
      Vec3 image = move.position;
      image[axis] = -image[axis];
      seeds.push_back({image, move.row.coefficient});
    }
  }
  extent_ = select_extent(rest_, space_, edit_.extent, seeds);
  sink_ = edit_.sink.kind == Sink::Kind::kOtherExtent
              ? select_extent(rest_, space_, edit_.sink.extent, seeds)
              : extent_;
}

Vec3 PreparedEdit::displacement(size_t k, const Vec3& value) const {
  return edit_.moves[k].relative ? value : Vec3(value - moves_[k].position);
}

void PreparedEdit::make_solver() {
  SolveProblem problem;
  problem.space = &space_;
  problem.volume = &volume_;
  problem.points = &rest_.points;
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
    const std::string reason = name + kKeepsTheEdge;
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
      const Patch& patch = rest_.patches[static_cast<size_t>(space_.patch_of(c))];
      ++locked[{label_of(patch), space_.lock_reason(c)}];
    }
  }
  for (const auto& [key, count] : locked) {
    certificate.locked.push_back({key.first, key.second, count});
  }
}

}  // namespace isochor
