#include "isochor/step/crossing_point.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "isochor/base/tolerance.h"

namespace isochor::internal {
namespace {

constexpr int kSteps = 20;
// The faces' planes make at least this angle (its sine): else they only touch, for all we know.
constexpr double kLeastSine = 1e-2;
// Along a walk normals turn by less than this (their cosine): it stays on one sheet.
constexpr double kSameSheet = 0.9;
// A common point, relative to the diagonal.
constexpr double kSamePoint = 1e-10;
constexpr int kDoublings = 16;
constexpr double kLongestWalk = 0.02;  // of the diagonal
constexpr int kStops = 4;              // looked at along each walk

Vec3 vec(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }

struct Tangents {
  Vec3 at, du, dv;
  Vec3 normal() const {
    const Vec3 n = du.cross(dv);
    const double size = n.norm();
    return size > kSingular * du.norm() * dv.norm() ? Vec3(n / size) : Vec3(Vec3::Zero());
  }
};

Tangents tangents(const FaceCells& face, const Uv& at) {
  gp_Pnt p;
  gp_Vec du, dv;
  face.surface()->D1(at.u, at.v, p, du, dv);
  return {vec(p.XYZ()), vec(du.XYZ()), vec(dv.XYZ())};
}

Uv clamped(const FaceCells& face, const Uv& p) {
  const UvBox& box = face.bounds();
  return {std::clamp(p.u, box.u_min, box.u_max), std::clamp(p.v, box.v_min, box.v_max)};
}

// The step in the parameters that moves the point by `move`, as far as its tangent plane allows.
Uv step_of(const Tangents& at, const Vec3& move) {
  const double e = at.du.dot(at.du), f = at.du.dot(at.dv), g = at.dv.dot(at.dv);
  const double det = e * g - f * f;
  if (!(det > kSingular * kSingular * e * g)) return {0.0, 0.0};
  const double p = move.dot(at.du), q = move.dot(at.dv);
  return {(p * g - q * f) / det, (q * e - p * f) / det};
}

// Newton's method for a common point: both move by the shortest way to the line in which their
// tangent planes meet.
bool meet(const FaceCells& face_a, Uv& a, const FaceCells& face_b, Uv& b, double diagonal) {
  for (int k = 0; k < kSteps; ++k) {
    const Tangents on_a = tangents(face_a, a), on_b = tangents(face_b, b);
    if ((on_a.at - on_b.at).norm() <= kSamePoint * diagonal) return true;
    const Vec3 na = on_a.normal(), nb = on_b.normal(), line = na.cross(nb);
    if (!(line.norm() > kLeastSine)) return false;
    Eigen::Matrix3d planes;
    planes << na.transpose(), nb.transpose(), line.transpose();
    const Vec3 heights(na.dot(on_a.at), nb.dot(on_b.at), line.dot(0.5 * (on_a.at + on_b.at)));
    const Vec3 target = planes.inverse() * heights;
    const Uv da = step_of(on_a, target - on_a.at), db = step_of(on_b, target - on_b.at);
    a = clamped(face_a, {a.u + da.u, a.v + da.v});
    b = clamped(face_b, {b.u + db.u, b.v + db.v});
  }
  return false;
}

// The signed distance of a point from a face near `foot`, which becomes its foot point; nothing
// when that is not clearly inside the face or on another sheet than `normal`.
std::optional<double> height_over(const FaceCells& face, Uv& foot, const Vec3& point,
                                  const Vec3& normal, double diagonal) {
  for (int k = 0; k < kSteps; ++k) {
    const Tangents at = tangents(face, foot);
    const Vec3 n = at.normal(), off = point - at.at;
    if (!(n.dot(normal) > kSameSheet)) return std::nullopt;
    const Vec3 along = off - off.dot(n) * n;
    if (along.norm() <= kSamePoint * diagonal) {
      if (face.where(foot) != Where::kInside) return std::nullopt;
      return off.dot(n);
    }
    const Uv step = step_of(at, along);
    foot = clamped(face, {foot.u + step.u, foot.v + step.v});
  }
  return std::nullopt;
}

// How far the walk from `start` in `face` by `move` gets away from `other`; signed.
std::optional<double> walk(const FaceCells& face, const Uv& start, const FaceCells& other, Uv foot,
                           const Vec3& move, double diagonal) {
  const Tangents at = tangents(face, start);
  const Vec3 normal = at.normal(), other_normal = tangents(other, foot).normal();
  const Uv step = step_of(at, move);
  std::optional<double> height;
  for (int k = 1; k <= kStops; ++k) {
    const double s = static_cast<double>(k) / kStops;
    const Uv here{start.u + s * step.u, start.v + s * step.v};
    if (face.where(here) != Where::kInside) return std::nullopt;
    const Tangents there = tangents(face, here);
    if (!(there.normal().dot(normal) > kSameSheet)) return std::nullopt;
    height = height_over(other, foot, there.at, other_normal, diagonal);
    if (!height) return std::nullopt;
  }
  return height;
}

// The depth by which walks of length h in `face` cross `other`; 0: they do not.
double depth_of(const FaceCells& face, const Uv& p, const FaceCells& other, const Uv& foot,
                const Vec3& across, double h, double diagonal) {
  const auto there = walk(face, p, other, foot, h * across, diagonal);
  if (!there) return 0.0;
  const auto back = walk(face, p, other, foot, -h * across, diagonal);
  if (!back || !(*there * *back < 0.0)) return 0.0;
  return std::min(std::abs(*there), std::abs(*back));
}

}  // namespace

std::optional<CrossingPoint> crossing_near(const FaceCells& face_a, Uv a, const FaceCells& face_b,
                                           Uv b, double limit, double diagonal) {
  if (!meet(face_a, a, face_b, b, diagonal)) return std::nullopt;
  if (face_a.where(a) != Where::kInside || face_b.where(b) != Where::kInside) return std::nullopt;
  const Tangents on_a = tangents(face_a, a), on_b = tangents(face_b, b);
  const Vec3 na = on_a.normal(), nb = on_b.normal(), line = na.cross(nb);
  const double sine = line.norm();
  if (!(sine > kLeastSine)) return std::nullopt;
  const Vec3 across_a = line.cross(na) / sine, across_b = line.cross(nb) / sine;
  CrossingPoint point{a, b, 0.5 * (on_a.at + on_b.at), 0.0};
  double h = 2.0 * limit / sine;
  for (int k = 0; k < kDoublings && (k == 0 || h <= kLongestWalk * diagonal); ++k, h *= 2.0) {
    const double depth = std::min(depth_of(face_a, a, face_b, b, across_a, h, diagonal),
                                  depth_of(face_b, b, face_a, a, across_b, h, diagonal));
    if (depth == 0.0) break;
    point.depth = std::max(point.depth, depth);
  }
  if (!(point.depth > limit)) return std::nullopt;
  return point;
}

}  // namespace isochor::internal
