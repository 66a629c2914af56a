#include "isochor/edit/prepared_edit.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/bspline/closest_point.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/model_refinement.h"
#include "isochor/bspline/refinement.h"
#include "isochor/bspline/trims.h"
#include "isochor/edit/extent_selection.h"
#include "isochor/edit/names.h"

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

std::string print(const Uv& uv) {
  std::ostringstream text;
  text.precision(6);
  text << "(" << uv.u << ", " << uv.v << ")";
  return text.str();
}

Uv parameters_of(const Patch& patch, const Place& place, const std::string& where) {
  const KnotVector& u = patch.u_knots;
  const KnotVector& v = patch.v_knots;
  Uv uv = place.uv;
  if (place.normalised) {
    const bool inside = 0.0 <= uv.u && uv.u <= 1.0 && 0.0 <= uv.v && uv.v <= 1.0;
    if (!inside) throw InputError("", where, "uv01 " + print(uv) + " is outside [0, 1] x [0, 1]");
    uv = {u.begin() + uv.u * (u.end() - u.begin()), v.begin() + uv.v * (v.end() - v.begin())};
    uv = {std::min(uv.u, u.end()), std::min(uv.v, v.end())};
  } else if (!(u.begin() <= uv.u && uv.u <= u.end() && v.begin() <= uv.v && uv.v <= v.end())) {
    std::ostringstream text;
    text << "uv " << print(uv) << " is outside the domain [" << u.begin() << ", " << u.end()
         << "] x [" << v.begin() << ", " << v.end() << "] of " << label_of(patch);
    throw InputError("", where, text.str());
  }
  if (!inside_trim(patch.trim, uv.u, uv.v)) {
    throw InputError(
        "", where,
        "uv " + print(uv) + " lies in a part of " + label_of(patch) + " that is trimmed away");
  }
  return uv;
}

ClosestPoint nearest_place(const PatchModel& model, const Vec3& near, const std::string& where) {
  const ClosestPoint found = closest_point(model, near);
  if (found.patch < 0) throw InputError("", where, "the model has no surface to be near to");
  return found;
}

// The patches that an edit's refine applies to: those of its moves and of the extents it names.
std::set<int> refined_patches(const PatchModel& model, const Edit& edit) {
  std::set<int> patches;
  for (const Move& move : edit.moves) {
    if (move.place.kind == Place::Kind::kNear) {
      patches.insert(nearest_place(model, move.place.near, "move").patch);
    } else {
      patches.insert(find_patch(model, move.place.patch));
    }
  }
  const auto add = [&](const Extent& extent) {
    if (!extent.patch.empty()) patches.insert(find_patch(model, extent.patch));
    for (const auto& item : extent.poles) patches.insert(find_patch(model, item.first));
    for (const std::string& face : extent.faces) patches.insert(find_patch(model, face));
    if (extent.kind != Extent::Kind::kAll) return;
    for (size_t q = 0; q < model.patches.size(); ++q) patches.insert(static_cast<int>(q));
  };
  add(edit.extent);
  if (edit.sink.kind == Sink::Kind::kOtherExtent) add(edit.sink.extent);
  return patches;
}

// The largest speeds |S_u| and |S_v| over a patch, from several samples in every span.
std::array<double, 2> largest_speeds(const Surface& surface) {
  constexpr int kSamples = 3;
  const auto samples = [](const KnotVector& knots) {
    std::vector<double> values;
    for (int span : knots.spans()) {
      for (int k = 0; k <= kSamples; ++k) {
        values.push_back(knots[span] + (knots[span + 1] - knots[span]) * k / kSamples);
      }
    }
    return values;
  };
  std::array<double, 2> speeds{};
  for (double u : samples(surface.u_knots())) {
    for (double v : samples(surface.v_knots())) {
      const SurfaceDerivatives at = surface.derivatives(u, v, 1);
      speeds[0] = std::max(speeds[0], at.su.norm());
      speeds[1] = std::max(speeds[1], at.sv.norm());
    }
  }
  return speeds;
}

}  // namespace

PatchModel refined_for(const PatchModel& model, const Edit& edit) {
  if (edit.refine.kind == Refine::Kind::kNone) return model;
  PatchModel refined = model;
  for (int q : refined_patches(model, edit)) {
    const Patch& patch = refined.patches[static_cast<size_t>(q)];
    KnotVector u = patch.u_knots;
    KnotVector v = patch.v_knots;
    if (edit.refine.kind == Refine::Kind::kSpans) {
      u = refined_to_spans(u, edit.refine.spans[0]);
      v = refined_to_spans(v, edit.refine.spans[1]);
    } else {
      const auto [u_speed, v_speed] = largest_speeds(refined.surface(q));
      if (u_speed > 0.0) u = refined_to_length(u, edit.refine.length / u_speed);
      if (v_speed > 0.0) v = refined_to_length(v, edit.refine.length / v_speed);
    }
    refined = refine(refined, q, u, v);
  }
  derive_locks(refined);
  return refined;
}

PreparedEdit::PreparedEdit(PatchModel rest, const Edit& edit)
    : rest_(std::move(rest)),
      edit_(edit),
      volume_(rest_),
      space_(rest_, {edit.scale, edit.continuity, symmetry_axes(edit)}),
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
  ResolvedPlace resolved;
  if (place.kind == Place::Kind::kNear) {
    const ClosestPoint found = nearest_place(rest_, place.near, where);
    resolved.patch = found.patch;
    resolved.uv = found.uv;
  } else {
    resolved.patch = find_patch(rest_, place.patch);
  }
  const Patch& patch = rest_.patches[static_cast<size_t>(resolved.patch)];
  if (place.kind == Place::Kind::kCoefficient) {
    const int nu = space_.u_knots(resolved.patch).size();
    const int nv = space_.v_knots(resolved.patch).size();
    if (place.i < 0 || place.j < 0 || place.i >= nu || place.j >= nv) {
      throw InputError("", where,
                       "pole [" + std::to_string(place.i) + ", " + std::to_string(place.j) +
                           "] is outside the grid of " + std::to_string(nu) + " x " +
                           std::to_string(nv) + " coefficients of the chosen scale");
    }
    resolved.coefficient = true;
    resolved.row = space_.grid_row(resolved.patch, place.i, place.j);
    const bool finest = patch.u_size() == nu && patch.v_size() == nv;
    resolved.position = finest ? rest_.points[static_cast<size_t>(patch.point(place.i, place.j))]
                               : space_.place(resolved.row.coefficient.front());
    resolved.text = label_of(patch) + " pole [" + std::to_string(place.i) + ", " +
                    std::to_string(place.j) + "]";
    return resolved;
  }
  if (place.kind == Place::Kind::kSurface) resolved.uv = parameters_of(patch, place, where);
  resolved.row = space_.surface_row(rest_, resolved.patch, resolved.uv);
  resolved.position = rest_.surface(resolved.patch).point(resolved.uv.u, resolved.uv.v);
  resolved.text = label_of(patch) + " at uv " + print(resolved.uv);
  return resolved;
}

void PreparedEdit::resolve_holds() {
  for (size_t k = 0; k < edit_.holds.size(); ++k) {
    const Hold& hold = edit_.holds[k];
    const std::string name = "hold[" + std::to_string(k) + "]";
    if (hold.kind == Hold::Kind::kPlace) {
      holds_.push_back(resolve(hold.place, name));
      hold_names_.push_back(name);
    } else if (hold.kind == Hold::Kind::kEdge) {
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
        throw InputError("", name + ".edge",
                         "\"" + hold.edge[0] + "\" and \"" + hold.edge[1] +
                             "\" share no edge along which both can move");
      }
      space_.lock_points(points, name + " keeps the edge");
    }
  }
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

SolveResult PreparedEdit::solve_for(const std::vector<Vec3>& values, double wanted_change,
                                    double volume_scale) const {
  ISOCHOR_REQUIRE(values.size() == moves_.size(), values.size(), moves_.size());
  SolveProblem problem;
  problem.space = &space_;
  problem.volume = &volume_;
  problem.points = &rest_.points;
  problem.extent = extent_;
  problem.sink = sink_;
  if (edit_.sink.kind == Sink::Kind::kDirection) problem.sink_direction = edit_.sink.direction;
  for (size_t k = 0; k < moves_.size(); ++k) {
    problem.constraints.push_back(
        {"move[" + std::to_string(k) + "]", moves_[k].row, displacement(k, values[k])});
  }
  for (size_t k = 0; k < holds_.size(); ++k) {
    problem.constraints.push_back({hold_names_[k], holds_[k].row, Vec3::Zero()});
  }
  problem.volume_free = edit_.volume.kind == VolumeGoal::Kind::kFree;
  problem.change = wanted_change;
  problem.volume_scale = volume_scale;
  problem.size = size_;
  problem.method = edit_.method;
  problem.axis_order = edit_.axis_order;
  return solve(problem);
}

std::vector<Vec3> PreparedEdit::displaced(const std::vector<Vec3>& delta) const {
  std::vector<Vec3> points = space_.expand(delta);
  for (size_t i = 0; i < points.size(); ++i) points[i] += rest_.points[i];
  return points;
}

void PreparedEdit::describe(Certificate& certificate) const {
  certificate.name = edit_.name;
  certificate.resolved = edit_;
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
