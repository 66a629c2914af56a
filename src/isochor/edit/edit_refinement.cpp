#include "isochor/edit/edit_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "isochor/base/error.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/model_refinement.h"
#include "isochor/bspline/refinement.h"
#include "isochor/bspline/trims.h"
#include "isochor/edit/names.h"
#include "isochor/edit/places.h"

namespace isochor {
namespace {

// Functions per direction that `auto` wants within reach of a moved point.
constexpr int kFreeFunctions = 4;
// New knots keep this part of a span away from old ones.
constexpr double kClose = 0.125;

// The patches that an edit's refine applies to: those of its moves and of the extents it names.
std::set<int> refined_patches(const PatchModel& model, const Edit& edit) {
  std::set<int> patches;
  for (const Move& move : edit.moves) {
    const bool near = move.place.kind == Place::Kind::kNear;
    patches.insert(near ? surface_place(model, move.place, "move").patch
                        : find_patch(model, move.place.patch));
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

// The parameters that must stay where they are: boxes around trimming curves, and locked sides.
std::vector<UvBox> obstacles(const PatchModel& model, int q) {
  const Patch& patch = model.patches[static_cast<size_t>(q)];
  const BoxRanges released = released_boxes(model, q);
  std::vector<UvBox> boxes;
  for (size_t k = 0; k < patch.trim.boundary.size(); ++k) {
    if (!contains(released, static_cast<int>(k))) boxes.push_back(patch.trim.boundary[k]);
  }
  for (size_t k = 0; k < model.locked_sides.size(); ++k) {
    const LockedSide& locked = model.locked_sides[k];
    if (locked.side.patch != q || side_is_released(model, static_cast<int>(k))) continue;
    UvBox box{patch.u_knots.begin(), patch.u_knots.end(), patch.v_knots.begin(),
              patch.v_knots.end()};
    const Side side = locked.side.side;
    if (side == Side::kUBegin) box.u_max = box.u_min;
    if (side == Side::kUEnd) box.u_min = box.u_max;
    if (side == Side::kVBegin) box.v_max = box.v_min;
    if (side == Side::kVEnd) box.v_min = box.v_max;
    boxes.push_back(box);
  }
  return boxes;
}

// From a number to an interval.
double distance(double value, double low, double high) {
  return std::max({0.0, low - value, value - high});
}

// `knots` with spans of at most `step` in [low, high], which reaches to a knot that is close; what
// lies outside stays as it is.
KnotVector refined_between(const KnotVector& knots, double low, double high, double step) {
  const std::vector<double> breaks = knots.breaks();
  std::vector<double> inserted;
  for (size_t k = 0; k + 1 < breaks.size(); ++k) {
    double begin = std::max(low, breaks[k]), end = std::min(high, breaks[k + 1]);
    if (begin - breaks[k] < kClose * step) begin = breaks[k];
    if (breaks[k + 1] - end < kClose * step) end = breaks[k + 1];
    if (!(begin < end) || breaks[k + 1] - breaks[k] <= step) continue;
    const int pieces = std::max(1, static_cast<int>(std::ceil((end - begin) / step)));
    for (int piece = 0; piece <= pieces; ++piece) {
      const double knot = piece == pieces ? end : begin + (end - begin) * piece / pieces;
      if (breaks[k] < knot && knot < breaks[k + 1]) inserted.push_back(knot);
    }
  }
  if (inserted.empty()) return knots;
  const bool wrapped = wrapped_poles(knots) > 0;
  return wrapped ? wrapped_with_knots(knots, inserted) : with_knots(knots, inserted);
}

PatchModel made_free(const PatchModel& model, const SurfacePlace& place, const Extent& extent) {
  const auto& [q, uv] = place;
  const Patch& patch = model.patches[static_cast<size_t>(q)];
  const SurfaceDerivatives at = model.surface(q).derivatives(uv.u, uv.v, 1);
  const double u_speed = at.su.norm(), v_speed = at.sv.norm();
  double reach = extent.kind == Extent::Kind::kRadius ? extent.radius
                                                      : std::numeric_limits<double>::infinity();
  for (const UvBox& box : obstacles(model, q)) {
    reach = std::min(reach, std::max(u_speed * distance(uv.u, box.u_min, box.u_max),
                                     v_speed * distance(uv.v, box.v_min, box.v_max)));
  }
  // On a trimming curve no knots help; at a pole of the surface there is no way along it.
  if (!(reach > 0.0) || !std::isfinite(reach) || !(u_speed > 0.0) || !(v_speed > 0.0)) return model;
  const auto refined = [&](const KnotVector& knots, double middle, double speed) {
    const double step = 2.0 * reach / (speed * (knots.degree() + kFreeFunctions));
    return refined_between(knots, middle - reach / speed, middle + reach / speed, step);
  };
  return refine(model, q, refined(patch.u_knots, uv.u, u_speed),
                refined(patch.v_knots, uv.v, v_speed));
}

PatchModel refined_around_moves(const PatchModel& model, const Edit& edit) {
  if (edit.moves.empty()) {
    throw InputError("", "refine", "\"auto\" refines around moved points, and there are none");
  }
  PatchModel refined = model;
  for (size_t k = 0; k < edit.moves.size(); ++k) {
    const Place& place = edit.moves[k].place;
    const std::string where = "move[" + std::to_string(k) + "]";
    if (place.kind == Place::Kind::kCoefficient) {
      throw InputError("", where,
                       "names a pole by its indices, which \"refine\": \"auto\" changes: name a "
                       "point of the surface");
    }
    refined = made_free(refined, surface_place(refined, place, where), edit.extent);
  }
  derive_locks(refined);
  return refined;
}

}  // namespace

PatchModel refined_for(const PatchModel& model, const Edit& edit) {
  if (edit.refine.kind == Refine::Kind::kNone) return model;
  if (edit.refine.kind == Refine::Kind::kAuto) return refined_around_moves(model, edit);
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

}  // namespace isochor
