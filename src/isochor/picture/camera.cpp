#include "isochor/picture/camera.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"

namespace isochor {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

// Any unit vector square to `axis`, the same one for the same axis.
Vec3 square_to(const Vec3& axis) {
  int least = 0;
  axis.cwiseAbs().minCoeff(&least);
  return axis.cross(Vec3::Unit(least)).normalized();
}

// The direction of a turn about the axis and a height over the horizon.
Vec3 direction(const Vec3& axis, double azimuth_rad, double elevation_rad) {
  // For z up the turn starts at +x and goes towards +y.
  Vec3 first = square_to(axis);
  if (std::abs(axis.z()) > 0.9) first = (Vec3::UnitX() - axis.x() * axis).normalized();
  const Vec3 second = axis.cross(first);
  return std::cos(elevation_rad) *
             (std::cos(azimuth_rad) * first + std::sin(azimuth_rad) * second) +
         std::sin(elevation_rad) * axis;
}

// Is there a triangle on the ray from `from` (a little off it) towards the eye?
bool hidden(const Mesh& mesh, const Vec3& from, const Vec3& toward, double near) {
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.positions[static_cast<size_t>(t[0])];
    const Vec3 e1 = mesh.positions[static_cast<size_t>(t[1])] - a;
    const Vec3 e2 = mesh.positions[static_cast<size_t>(t[2])] - a;
    const Vec3 p = toward.cross(e2);
    const double det = e1.dot(p);
    if (det == 0.0) continue;
    const Vec3 s = from - a;
    const double u = s.dot(p) / det;
    if (u < 0.0 || u > 1.0) continue;
    const Vec3 q = s.cross(e1);
    const double v = toward.dot(q) / det;
    if (v < 0.0 || u + v > 1.0) continue;
    if (e2.dot(q) / det > near) return true;
  }
  return false;
}

// How much wider than high the box looks, 0 (not at all) to 1 (three times): long things look
// best lying down.
double lies_down(const Box& box, const Vec3& toward, const Vec3& axis) {
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k) {
    corners.emplace_back(k & 1 ? box.high.x() : box.low.x(), k & 2 ? box.high.y() : box.low.y(),
                         k & 4 ? box.high.z() : box.low.z());
  }
  const Frame2d frame = covered(look_along(toward, axis), corners);
  if (!(frame.height() > 0.0)) return 1.0;
  return std::clamp(std::log(frame.width() / frame.height()) / std::log(3.0), 0.0, 1.0);
}

struct Candidate {
  Vec3 toward;
  double score;
};

}  // namespace

Camera look_along(const Vec3& toward, const Vec3& axis) {
  ISOCHOR_REQUIRE(toward.norm() > 0.0 && axis.norm() > 0.0, toward.transpose(), axis.transpose());
  Camera camera;
  camera.toward = toward.normalized();
  const Vec3 right = axis.normalized().cross(camera.toward);
  camera.right = right.norm() > 1e-6 ? Vec3(right.normalized()) : square_to(camera.toward);
  camera.up = camera.toward.cross(camera.right);
  return camera;
}

Vec3 three_quarter_view(const Vec3& axis) {
  return direction(axis.normalized(), -58.0 * kDegree, 27.0 * kDegree);
}

Vec3 view_of_focus(const Mesh& mesh, const Vec3& focus, const Vec3& normal, const Vec3& axis) {
  const Vec3 upright = axis.normalized();
  const Vec3 usual = three_quarter_view(upright);
  if (!(normal.norm() > 0.0)) return usual;
  const Vec3 n = normal.normalized();
  const Box box = bounding_box(mesh);
  if (box.empty()) return usual;
  std::vector<Candidate> candidates;
  for (double elevation : {27.0, 42.0, 12.0, 60.0, -20.0, -45.0}) {
    for (int turn = 0; turn < 24; ++turn) {
      const Vec3 toward = direction(upright, (-58.0 + 15.0 * turn) * kDegree, elevation * kDegree);
      const double facing = toward.dot(n);
      if (facing < 0.25) continue;
      // Best seen a little from the side; views from below and far from the usual one cost.
      const double slant = facing - 0.80;
      const double score = -3.0 * slant * slant + 0.22 * toward.dot(usual) -
                           (elevation < 0.0 ? 0.35 : 0.0) - (elevation > 50.0 ? 0.1 : 0.0) +
                           0.4 * lies_down(box, toward, upright);
      candidates.push_back({toward, score});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  const double off = 2e-3 * box.diagonal();
  const size_t tries = std::min<size_t>(candidates.size(), 24);
  for (size_t k = 0; k < tries; ++k) {
    if (!hidden(mesh, focus + off * n, candidates[k].toward, off)) return candidates[k].toward;
  }
  return candidates.empty() ? usual : candidates.front().toward;
}

Frame2d covered(const Camera& camera, const std::vector<Vec3>& points) {
  ISOCHOR_REQUIRE(!points.empty());
  Frame2d frame = {1e308, -1e308, 1e308, -1e308};
  for (const Vec3& p : points) {
    const double x = camera.right.dot(p), y = camera.up.dot(p);
    frame.right_min = std::min(frame.right_min, x);
    frame.right_max = std::max(frame.right_max, x);
    frame.up_min = std::min(frame.up_min, y);
    frame.up_max = std::max(frame.up_max, y);
  }
  return frame;
}

Camera fit(Camera camera, const Frame2d& frame, int width, int height, double margin) {
  ISOCHOR_REQUIRE(width > 2 * margin && height > 2 * margin, width, height, margin);
  camera.width = width;
  camera.height = height;
  const double x = 0.5 * (frame.right_min + frame.right_max);
  const double y = 0.5 * (frame.up_min + frame.up_max);
  camera.centre = x * camera.right + y * camera.up;
  const double tiny = 1e-300;
  camera.scale = std::min((width - 2 * margin) / std::max(frame.width(), tiny),
                          (height - 2 * margin) / std::max(frame.height(), tiny));
  if (!(frame.width() > 0.0) && !(frame.height() > 0.0)) camera.scale = 1.0;
  return camera;
}

}  // namespace isochor
