#include "isochor/step/cell_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace isochor::internal {
namespace {

double distance_to(const std::vector<Vec3>& line, const Vec3& p) {
  double least = (line.front() - p).squaredNorm();
  for (size_t k = 1; k < line.size(); ++k) {
    const Vec3 d = line[k] - line[k - 1], off = p - line[k - 1];
    const double length = d.squaredNorm();
    const double s = length > 0.0 ? std::clamp(off.dot(d) / length, 0.0, 1.0) : 0.0;
    least = std::min(least, (off - s * d).squaredNorm());
  }
  return std::sqrt(least);
}

}  // namespace

double distance_to(const Shared& shared, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto* line : shared) least = std::min(least, distance_to(*line, p));
  return least;
}

bool parted(const Cell& a, const Cell& b, const Vec3& normal) {
  const auto range = [&](const Cell& cell) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3& p : cell.hull) {
      low = std::min(low, normal.dot(p));
      high = std::max(high, normal.dot(p));
    }
    return std::pair(low - cell.radius, high + cell.radius);
  };
  const auto [low_a, high_a] = range(a);
  const auto [low_b, high_b] = range(b);
  return high_a < low_b || high_b < low_a;
}

bool boxes_meet(const Cell& a, const Cell& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

Vec3 normal_of(const FaceCells& face, const Cell& cell) {
  const auto at = [&](double u, double v) {
    const gp_Pnt p = face.surface()->Value(u, v);
    return Vec3(p.X(), p.Y(), p.Z());
  };
  const UvBox& uv = cell.uv;
  const Vec3 n = (at(uv.u_max, uv.v_max) - at(uv.u_min, uv.v_min))
                     .cross(at(uv.u_min, uv.v_max) - at(uv.u_max, uv.v_min));
  const double size = n.norm();
  return size > 0.0 ? Vec3(n / size) : Vec3(Vec3::Zero());
}

Uv middle_of(const Cell& cell) {
  return {0.5 * (cell.uv.u_min + cell.uv.u_max), 0.5 * (cell.uv.v_min + cell.uv.v_max)};
}

bool near_shared(const Cell& a, const Cell& b, const Shared& shared, double strip) {
  if (!(strip > 0.0) || shared.empty()) return false;
  const Vec3 low = a.low.cwiseMax(b.low), high = a.high.cwiseMin(b.high);
  const double half = 0.5 * (high - low).norm();
  return half < strip && distance_to(shared, 0.5 * (low + high)) + half <= strip;
}

}  // namespace isochor::internal
