#include "isochor/bspline/patch_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <sstream>

#include "isochor/base/error.h"

namespace isochor {
namespace {

std::string label(const Patch& patch) {
  return "patch " + patch.handle + (patch.name.empty() ? "" : " (\"" + patch.name + "\")");
}

void validate_patch(const Patch& patch, size_t point_count) {
  const auto expected = static_cast<size_t>(patch.u_size()) * static_cast<size_t>(patch.v_size());
  if (patch.points.size() != expected) {
    throw InputError("", label(patch),
                     std::to_string(patch.points.size()) + " poles do not fit " +
                         std::to_string(patch.u_size()) + " x " + std::to_string(patch.v_size()));
  }
  for (int id : patch.points) {
    if (id < 0 || static_cast<size_t>(id) >= point_count) {
      throw InputError("", label(patch),
                       "pole index " + std::to_string(id) + " is not in the table of " +
                           std::to_string(point_count) + " points");
    }
  }
  if (!patch.weights.empty() && patch.weights.size() != expected) {
    throw InputError("", label(patch),
                     std::to_string(patch.weights.size()) + " weights do not fit the poles");
  }
  for (double w : patch.weights) {
    if (w > 0.0 && std::isfinite(w)) continue;
    std::ostringstream text;
    text.precision(17);
    text << "weight " << w << (w > 0.0 ? " is not finite" : " is not positive");
    throw InputError("", label(patch), text.str());
  }
}

}  // namespace

const char* name_of(Smoothness smoothness) {
  switch (smoothness) {
    case Smoothness::kSharp:
      return "C0";
    case Smoothness::kAlmost:
      return "almost G1";
    case Smoothness::kTangent:
      return "G1";
    case Smoothness::kCurvature:
      return "G2";
  }
  return "?";
}

Surface PatchModel::surface(int q, const std::vector<Vec3>& at) const {
  const Patch& patch = patches[static_cast<size_t>(q)];
  std::vector<Vec3> poles;
  poles.reserve(patch.points.size());
  for (int id : patch.points) poles.push_back(at[static_cast<size_t>(id)]);
  return Surface(patch.u_knots, patch.v_knots, std::move(poles), patch.weights);
}

void PatchModel::lock(int point, const std::string& reason, bool continuity) {
  auto found = std::find_if(lock_reasons.begin(), lock_reasons.end(), [&](const LockReason& known) {
    return known.text == reason && known.continuity == continuity;
  });
  if (found == lock_reasons.end()) {
    lock_reasons.push_back({reason, continuity});
    found = lock_reasons.end() - 1;
  }
  locks.push_back({point, static_cast<int>(found - lock_reasons.begin())});
}

void validate(const PatchModel& model) {
  for (size_t i = 0; i < model.points.size(); ++i) {
    if (!model.points[i].allFinite()) {
      throw InputError("", "point " + std::to_string(i), "a coordinate is not a finite number");
    }
  }
  std::set<std::string> handles;
  for (const Patch& patch : model.patches) {
    validate_patch(patch, model.points.size());
    if (!handles.insert(patch.handle).second) {
      throw InputError("", label(patch), "the handle is used twice");
    }
  }
  const auto count = static_cast<int>(model.points.size());
  for (const auto& [a, b] : model.ties) {
    if (a < 0 || b < 0 || a >= count || b >= count) {
      throw InputError("", "tie [" + std::to_string(a) + ", " + std::to_string(b) + "]",
                       "not in the table of " + std::to_string(count) + " points");
    }
  }
}

double diagonal(const PatchModel& model) {
  if (model.points.empty()) return 0.0;
  Vec3 low = model.points.front();
  Vec3 high = low;
  for (const Vec3& p : model.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

PointClasses point_classes(const PatchModel& model) {
  const size_t count = model.points.size();
  std::vector<int> parent(count);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[static_cast<size_t>(i)] != i) {
      auto& up = parent[static_cast<size_t>(i)];
      up = parent[static_cast<size_t>(up)];
      i = up;
    }
    return i;
  };
  for (const auto& [a, b] : model.ties) {
    const int ra = root(a);
    const int rb = root(b);
    parent[static_cast<size_t>(std::max(ra, rb))] = std::min(ra, rb);
  }
  PointClasses classes;
  classes.class_of.assign(count, -1);
  for (size_t i = 0; i < count; ++i) {
    const auto r = static_cast<size_t>(root(static_cast<int>(i)));
    if (r == i) {
      classes.class_of[i] = static_cast<int>(classes.representative.size());
      classes.representative.push_back(static_cast<int>(i));
    } else {
      classes.class_of[i] = classes.class_of[r];
    }
  }
  return classes;
}

std::vector<std::pair<int, int>> side_indices(const Patch& patch, Side side, int depth) {
  const int nu = patch.u_size();
  const int nv = patch.v_size();
  ISOCHOR_REQUIRE(0 <= depth && depth < (is_u_side(side) ? nu : nv), depth, nu, nv);
  std::vector<std::pair<int, int>> indices;
  if (is_u_side(side)) {
    const int i = side == Side::kUBegin ? depth : nu - 1 - depth;
    for (int j = 0; j < nv; ++j) indices.emplace_back(i, j);
  } else {
    const int j = side == Side::kVBegin ? depth : nv - 1 - depth;
    for (int i = 0; i < nu; ++i) indices.emplace_back(i, j);
  }
  return indices;
}

}  // namespace isochor
