#include "isochor/volume/below.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/volume/below_cells.h"
#include "isochor/volume/element_fields.h"

namespace isochor {
namespace {

using internal::BezierCell;
using internal::Frame;

// Roundings of a coordinate from pole to Gauss point, for the degrees in use.
constexpr double kCoordinateNoise = 128 * kUnitRoundoff;
constexpr double kNegligible = kUnitRoundoff / 64;  // of a cell, in units of reach^3
// The field must not run along the waterline: its slope is the inverse of this.
constexpr double kLeastCrossing = 1e-3;

bool parallel(const Vec3& a, const Vec3& b) { return a.cross(b).norm() <= kSameDirection; }
bool perpendicular(const Vec3& a, const Vec3& b) { return std::abs(a.dot(b)) <= kSameDirection; }

// The planes whose caps may lie below.
std::vector<ClosingPlane> that_matter(const ClosingPlane& plane,
                                      const std::vector<ClosingPlane>& closing) {
  std::vector<ClosingPlane> result;
  for (const ClosingPlane& other : closing) {
    const double sign = other.normal.dot(plane.normal) < 0.0 ? -1.0 : 1.0;
    if (parallel(other.normal, plane.normal) && sign * other.offset >= plane.offset) continue;
    result.push_back(other);
  }
  return result;
}

// The direction in all these planes that is nearest to n; zero when there is none across it.
Vec3 direction_across(const std::vector<ClosingPlane>& planes, const Vec3& n) {
  if (planes.empty()) return n;
  const Vec3& first = planes.front().normal;
  Vec3 line = Vec3::Zero();
  for (const ClosingPlane& other : planes) {
    if (const Vec3 cross = first.cross(other.normal); cross.norm() > line.norm()) line = cross;
  }
  Vec3 found = n;
  if (!perpendicular(first, n) || line.norm() > kSameDirection) {
    found = line.norm() <= kSameDirection ? Vec3(n - first * first.dot(n)) : line;
  }
  if (!(found.norm() > kLeastCrossing)) return Vec3::Zero();
  found.normalize();
  for (const ClosingPlane& other : planes) {
    if (!perpendicular(other.normal, found)) return Vec3::Zero();
  }
  if (found.dot(n) < 0.0) found = -found;
  if ((found - n).norm() <= kSameDirection) return n;
  return found.dot(n) > kLeastCrossing ? found : Vec3(Vec3::Zero());
}

}  // namespace

ClosingPlane parse_waterline(const std::string& text) {
  ClosingPlane plane = parse_closing_plane(text);
  if (text.find(',') == std::string::npos) return plane;
  std::istringstream parts(text);
  Vec3 normal = Vec3::Zero();
  char comma = 0;
  parts >> normal.x() >> comma >> normal.y() >> comma >> normal.z();
  if (normal.dot(plane.normal) < 0.0) {
    plane.normal = -plane.normal;
    plane.offset = -plane.offset;
  }
  return plane;
}

std::optional<FluxField> field_below(const ClosingPlane& plane,
                                     const std::vector<ClosingPlane>& closing) {
  std::vector<ClosingPlane> planes = that_matter(plane, closing);
  const Vec3 across = direction_across(planes, plane.normal);
  if (across != Vec3::Zero()) {
    const double along = plane.normal.dot(across);
    return FluxField{plane.normal / along, across, plane.offset / along};
  }
  planes.push_back(plane);
  return field_without_flux(planes);
}

FluxField require_field_below(const ClosingPlane& plane, const std::vector<ClosingPlane>& closing) {
  const std::optional<FluxField> field = field_below(plane, closing);
  if (field) return *field;
  throw InputError("", "the plane " + text_of(plane),
                   "with the closing planes " + text_of(that_matter(plane, closing)) +
                       " no direction lies in all of them but one, so what is below cannot be "
                       "measured on the skin alone: cap the model in your CAD");
}

void set_centroid(const Vec3& first, const Vec3& first_bound, const Vec3& origin, PartBelow& part) {
  part.centroid = Vec3::Zero();
  part.centroid_bound = std::numeric_limits<double>::infinity();
  const double least = std::abs(part.volume) - part.bound;
  if (!(least > 0.0)) return;
  const Vec3 away = first / part.volume;
  part.centroid = origin + away;
  part.centroid_bound = (first_bound.norm() + away.norm() * part.bound) / least +
                        8 * kUnitRoundoff * part.centroid.norm();
}

PartBelow part_below(const PatchModel& model, const ClosingPlane& plane,
                     const std::vector<ClosingPlane>& closing) {
  PartBelow part;
  part.normal = plane.normal;
  part.height = plane.offset;
  part.centroid_bound = std::numeric_limits<double>::infinity();
  if (model.points.empty()) return part;
  Vec3 low = model.points.front();
  Vec3 high = low;
  for (const Vec3& p : model.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const FluxField field =
      require_field_below(plane, internal::caps_below(plane, closing, low, high));
  const Frame frame = internal::plane_frame(model.points, plane.normal, plane.offset);
  const double reach = internal::reach_of(model.points, frame);
  const double noise = kCoordinateNoise * reach + 4 * kUnitRoundoff * frame.origin.norm();
  internal::BelowSums sums(internal::in_frame(field, frame), noise,
                           kNegligible * reach * reach * reach);
  for (const Patch& patch : model.patches) {
    internal::require_poles(patch, model.points.size());
    for (const BezierCell& cell : internal::cells_of(patch, model.points, frame)) {
      sums.add(cell, patch.sign());
    }
  }
  part.proven = sums.proven();
  if (!sums.any_below()) return part;
  part.side = sums.any_above() ? PlaneSide::kCut : PlaneSide::kEverything;
  part.volume = sums.value(0);
  part.bound = sums.error(0);
  set_centroid(frame.axes.transpose() * Vec3(sums.value(1), sums.value(2), sums.value(3)),
               Vec3(sums.error(1), sums.error(2), sums.error(3)), frame.origin, part);
  return part;
}

}  // namespace isochor
