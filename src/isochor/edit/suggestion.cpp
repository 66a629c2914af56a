#include "isochor/edit/suggestion.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/bspline/trims.h"
#include "isochor/edit/displacement_space.h"
#include "isochor/edit/edit_refinement.h"
#include "isochor/edit/prepared_edit.h"

namespace isochor {
namespace {

// Steps on the control net from each coefficient to the nearest locked one; unreached: the largest
// int (nothing is locked).
std::vector<int> clearances(const DisplacementSpace& space) {
  std::vector<int> steps(static_cast<size_t>(space.size()), std::numeric_limits<int>::max());
  std::vector<int> front;
  for (int c = 0; c < space.size(); ++c) {
    if (space.locked_axes(c) == 0) continue;
    steps[static_cast<size_t>(c)] = 0;
    front.push_back(c);
  }
  while (!front.empty()) {
    std::vector<int> next;
    for (int c : front) {
      for (int other : space.neighbours(c)) {
        if (steps[static_cast<size_t>(other)] != std::numeric_limits<int>::max()) continue;
        steps[static_cast<size_t>(other)] = steps[static_cast<size_t>(c)] + 1;
        next.push_back(other);
      }
    }
    front = std::move(next);
  }
  return steps;
}

struct FreePlace {
  Uv uv;
  int rings = 0;
};

// The coefficient of patch q farthest from everything locked; among equals the one nearest to the
// middle of the parameter domain. Only places with a normal count.
FreePlace freest_place(const PatchModel& model, const DisplacementSpace& space, int q) {
  const std::vector<int> steps = clearances(space);
  const KnotVector& u = space.u_knots(q);
  const KnotVector& v = space.v_knots(q);
  const Surface surface = model.surface(q);
  FreePlace best;
  double best_offset = 0.0;
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      const Uv uv{u.greville(i), v.greville(j)};
      const double du = (uv.u - u.begin()) / (u.end() - u.begin()) - 0.5;
      const double dv = (uv.v - v.begin()) / (v.end() - v.begin()) - 0.5;
      const double offset = du * du + dv * dv;
      const int rings = steps[static_cast<size_t>(space.coefficient(q, i, j))];
      if (rings < best.rings || (rings == best.rings && (rings == 0 || offset >= best_offset))) {
        continue;
      }
      if (!inside_trim(model.patches[static_cast<size_t>(q)].trim, uv.u, uv.v)) continue;
      if (surface.normal(uv.u, uv.v) == Vec3::Zero()) continue;  // a sharp tip has no outwards
      best = {uv, rings};
      best_offset = offset;
    }
  }
  return best;
}

double patch_size(const PatchModel& model, const Patch& patch) {
  Vec3 low = model.points[static_cast<size_t>(patch.points.front())];
  Vec3 high = low;
  for (int id : patch.points) {
    low = low.cwiseMin(model.points[static_cast<size_t>(id)]);
    high = high.cwiseMax(model.points[static_cast<size_t>(id)]);
  }
  return (high - low).norm();
}

// The edit at the freest place of one patch refined to `spans` (0: as it is), when it is free
// enough and works.
std::optional<Edit> try_patch(const PatchModel& model, const Surroundings& surroundings, int q,
                              int spans, const SuggestionOptions& options) {
  Edit edit;
  edit.name = "pull the freest place";
  edit.continuity = options.continuity;
  const Patch& patch = model.patches[static_cast<size_t>(q)];
  Move move;
  move.place.patch = patch.handle;
  move.place.uv = {patch.u_knots.begin(), patch.v_knots.begin()};
  if (spans > 0) {
    edit.refine.kind = Refine::Kind::kSpans;
    edit.refine.spans = {spans, spans};
    edit.moves = {move};
  }
  const PatchModel refined = refined_for(model, edit);
  DisplacementSpace::Options kept;
  kept.continuity = options.continuity;
  const DisplacementSpace space(refined, kept);
  const FreePlace place = freest_place(refined, space, q);
  if (place.rings < options.enough_rings) return std::nullopt;
  constexpr int kMostRings = 6;
  edit.extent.rings = std::min(place.rings, kMostRings);
  move.place.uv = place.uv;
  const Vec3 normal = patch.sign() * model.surface(q).normal(place.uv.u, place.uv.v);
  move.vector = options.relative_pull * diagonal(model) * normal;
  edit.moves = {move};
  if (!surroundings.closed) edit.volume.kind = VolumeGoal::Kind::kFree;
  EditSession session(model, surroundings);
  if (session.begin(edit).outcome != Outcome::kDone) return std::nullopt;
  return edit;
}

}  // namespace

std::optional<Edit> suggest_edit(const PatchModel& model, const Surroundings& surroundings,
                                 const SuggestionOptions& options) {
  std::vector<int> order(model.patches.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> sizes;
  for (const Patch& patch : model.patches) sizes.push_back(patch_size(model, patch));
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return sizes[static_cast<size_t>(a)] > sizes[static_cast<size_t>(b)];
  });
  constexpr size_t kMostPatches = 12;
  if (order.size() > kMostPatches) order.resize(kMostPatches);
  for (int spans = 0; spans <= options.most_spans; spans = spans == 0 ? 12 : 2 * spans) {
    for (int q : order) {
      if (std::optional<Edit> edit = try_patch(model, surroundings, q, spans, options)) return edit;
    }
  }
  return std::nullopt;
}

}  // namespace isochor
