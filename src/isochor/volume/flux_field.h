// Planes that close an open model, and the field whose flux through its skin alone is the volume.
//
// Symbols: planes n_i . x = h_i that close the skin; a field F(x) = (slope . x - level) direction
// with slope . direction == 1, so div F = 1 and the flux of F out of a closed body is its volume.
// Where F . n_i = 0 on every closing plane the caps have no flux: the volume of the closed body is
// the flux through the skin, and no cap is made. That holds when the direction lies in every plane
// but at most one, and slope . x = level is that one.
//
// The *frame* of a field are coordinates (x', y', z') = A x - (0, 0, level), det A = 1, in which F
// is (0, 0, z'): its flux is the integral of z' dx' dy'. For a coordinate axis A turns the axes
// round; coordinates keep their bits then.
//
// Laws (tests of those names in tests/volume/flux_field_test.cpp):
//  (1) unit divergence: slope . direction == 1;
//  (2) no flux: F . n == 0 on all points of all planes;
//  (3) frame: det A == 1, and A direction == (0, 0, 1);
//  (4) refused planes are not refused for their order or the length of their normals.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "isochor/base/vec3.h"

namespace isochor {

// One plane, normal . x = offset.
struct ClosingPlane {
  Vec3 normal = Vec3::UnitZ();  // of length one
  double offset = 0.0;
  bool mirror = false;  // the body goes on as its mirror image beyond the plane
};

// The plane with a normal of any length. InputError, naming `entity`, for zero or not finite.
ClosingPlane closing_plane(const Vec3& normal, double offset, const std::string& entity);
// "y=0", "z=12.5" or "NX,NY,NZ,H". InputError for anything else.
ClosingPlane parse_closing_plane(const std::string& text);
// "y = 0", "0.6 x + 0.8 z = 12.5".
std::string text_of(const ClosingPlane& plane);
// "2 planes (y = 0, z = 12.5)", "the plane y = 0".
std::string text_of(const std::vector<ClosingPlane>& planes);
// The same plane, but for rounding of normals and of offsets of this size.
bool same_plane(const ClosingPlane& a, const ClosingPlane& b);

struct FluxField {
  Vec3 slope = Vec3::UnitZ(), direction = Vec3::UnitZ();
  double level = 0.0;
  Vec3 at(const Vec3& x) const { return (slope.dot(x) - level) * direction; }
};

// A field without flux through the planes; without planes, that of the integral of z dx dy. Empty
// when no direction lies in all planes but one. Coordinate axes and levels of zero come first.
std::optional<FluxField> field_without_flux(const std::vector<ClosingPlane>& planes);
// The same, for planes that come from outside: an InputError says why there is none.
FluxField require_field(const std::vector<ClosingPlane>& planes);

// A point on all planes: fields f(x - p)(x - p) have no flux through them. Empty when there is
// none.
std::optional<Vec3> common_point(const std::vector<ClosingPlane>& planes);

class FluxFrame {
 public:
  FluxFrame() = default;
  explicit FluxFrame(const FluxField& field);

  // Nothing to do: x' = x.
  bool plain() const { return plain_; }
  // Coordinates keep their bits.
  bool exact() const { return exact_; }
  const Eigen::Matrix3d& matrix() const { return matrix_; }

  Vec3 point(const Vec3& x) const;
  std::vector<Vec3> points(const std::vector<Vec3>& at) const;
  std::vector<Vec3> directions(const std::vector<Vec3>& along) const;
  // Gradients with respect to x' become gradients with respect to x.
  void pull_back(std::vector<Vec3>& rows) const;
  // At most this far is each coordinate of point(x) from its exact value.
  double slip(const Vec3& x) const;

 private:
  Eigen::Matrix3d matrix_ = Eigen::Matrix3d::Identity();
  double level_ = 0.0;
  bool plain_ = true, exact_ = true;
};

}  // namespace isochor
