#include "isochor/multires/model_scale.h"

#include <algorithm>
#include <optional>
#include <sstream>
#include <string>

#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"

namespace isochor {
namespace {

// Directions are numbered 2 * patch + (0 for u, 1 for v).
int direction_index(int patch, Direction direction) {
  return 2 * patch + (direction == Direction::kU ? 0 : 1);
}

// Two directions whose knots correspond one to one because they run along a matching join.
struct Link {
  int a, b;
  bool opposed;
};

std::vector<Link> links_of(const PatchModel& model) {
  std::vector<Link> links;
  for (const Join& join : model.joins.empty() ? find_joins(model) : model.joins) {
    if (!join.matching) continue;
    links.push_back({direction_index(join.a.patch, running_direction(join.a.side)),
                     direction_index(join.b.patch, running_direction(join.b.side)), join.opposed});
  }
  return links;
}

std::vector<const KnotVector*> knots_of_model(const PatchModel& model) {
  std::vector<const KnotVector*> knots;
  for (const Patch& patch : model.patches) {
    knots.push_back(&patch.u_knots);
    knots.push_back(&patch.v_knots);
  }
  return knots;
}

using Flags = std::vector<bool>;

Flags carried(Flags flags, bool opposed) {
  if (opposed) std::reverse(flags.begin(), flags.end());
  return flags;
}

// Spreads flags along the links until nothing changes: a direction without flags takes its
// neighbour's, one that has some takes those it lacks. Terminates: flags are only ever added.
void spread(const std::vector<Link>& links, std::vector<std::optional<Flags>>* flags) {
  const auto take = [&](int to, int from, bool opposed) {
    const auto& source = (*flags)[static_cast<size_t>(from)];
    auto& target = (*flags)[static_cast<size_t>(to)];
    if (!source) return false;
    const Flags incoming = carried(*source, opposed);
    if (!target) {
      target = incoming;
      return true;
    }
    ISOCHOR_REQUIRE(target->size() == incoming.size(), target->size(), incoming.size());
    bool changed = false;
    for (size_t i = 0; i < incoming.size(); ++i) {
      if (incoming[i] && !(*target)[i]) (*target)[i] = changed = true;
    }
    return changed;
  };
  bool changed = true;
  while (changed) {
    changed = false;
    for (const Link& link : links) {
      if (take(link.b, link.a, link.opposed)) changed = true;
      if (take(link.a, link.b, link.opposed)) changed = true;
    }
  }
}

std::vector<PatchScale> build(const PatchModel& model,
                              const std::vector<std::optional<Flags>>& flags) {
  const PointClasses classes = point_classes(model);
  std::vector<PatchScale> scales;
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const Patch& patch = model.patches[static_cast<size_t>(q)];
    const auto scale = [&](Direction direction) {
      const auto& kept = flags[static_cast<size_t>(direction_index(q, direction))];
      const KnotVector& knots = knots_of(patch, direction);
      const Flags all(interior_breaks(knots).size(), true);
      const Wrap wrap = wrapped_rows(patch, direction, classes) > 0 ? Wrap::kYes : Wrap::kNo;
      if (!kept || *kept == all) return TwoScale{knots, BandedMap::identity(knots.size())};
      return keep_flagged(knots, *kept, wrap);
    };
    scales.push_back({scale(Direction::kU), scale(Direction::kV)});
  }
  return scales;
}

std::string print(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

Flags flags_for(const KnotVector& knots, const std::vector<double>& kept, const Patch& patch) {
  const std::vector<double> breaks = interior_breaks(knots);
  try {
    // Checks the values and words the error.
    (void)keep_knots(knots, kept);
  } catch (const InputError& error) {
    throw InputError("", "scale.knots of " + label_of(patch), error.reason());
  }
  Flags flags;
  for (double t : breaks) flags.push_back(std::find(kept.begin(), kept.end(), t) != kept.end());
  return flags;
}

}  // namespace

std::vector<PatchScale> finest_scale(const PatchModel& model) {
  return build(model, std::vector<std::optional<Flags>>(2 * model.patches.size()));
}

std::vector<PatchScale> keep_every(const PatchModel& model, int k) {
  if (k < 1) throw InputError("", "scale.every", std::to_string(k) + " is not at least 1");
  const std::vector<Link> links = links_of(model);
  const auto knots = knots_of_model(model);
  std::vector<std::optional<Flags>> flags(knots.size());
  for (size_t i = 0; i < knots.size(); ++i) {
    if (flags[i]) continue;
    Flags own(interior_breaks(*knots[i]).size());
    for (size_t b = 0; b < own.size(); ++b) own[b] = (b + 1) % static_cast<size_t>(k) == 0;
    flags[i] = own;
    spread(links, &flags);
  }
  return build(model, flags);
}

std::vector<PatchScale> keep_knots(const PatchModel& model, const std::vector<KeptKnots>& kept) {
  const std::vector<Link> links = links_of(model);
  std::vector<std::optional<Flags>> flags(2 * model.patches.size());
  for (const KeptKnots& list : kept) {
    ISOCHOR_REQUIRE(0 <= list.patch && list.patch < static_cast<int>(model.patches.size()),
                    list.patch, model.patches.size());
    const Patch& patch = model.patches[static_cast<size_t>(list.patch)];
    flags[static_cast<size_t>(direction_index(list.patch, Direction::kU))] =
        flags_for(patch.u_knots, list.u, patch);
    flags[static_cast<size_t>(direction_index(list.patch, Direction::kV))] =
        flags_for(patch.v_knots, list.v, patch);
  }
  const std::vector<std::optional<Flags>> asked = flags;
  spread(links, &flags);
  // The patch whose list alone carries knot `at` to direction i.
  const auto keeper = [&](size_t i, size_t at) {
    for (size_t j = 0; j < asked.size(); ++j) {
      if (j == i || !asked[j]) continue;
      std::vector<std::optional<Flags>> alone(asked.size());
      alone[j] = asked[j];
      spread(links, &alone);
      if (alone[i] && (*alone[i])[at]) return label_of(model.patches[j / 2]);
    }
    return std::string("a joined patch");
  };
  for (size_t i = 0; i < asked.size(); ++i) {
    if (!asked[i] || asked[i] == flags[i]) continue;
    const Patch& patch = model.patches[i / 2];
    const auto breaks = interior_breaks(i % 2 == 0 ? patch.u_knots : patch.v_knots);
    size_t at = 0;
    while ((*asked[i])[at] == (*flags[i])[at]) ++at;
    throw InputError("", "scale.knots of " + label_of(patch),
                     std::string(i % 2 == 0 ? "u" : "v") + " knot " + print(breaks[at]) +
                         " is left out here but kept by the list of " + keeper(i, at) +
                         ", which is joined to it");
  }
  return build(model, flags);
}

}  // namespace isochor
