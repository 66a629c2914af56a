#include "isochor/volume/flux_field.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"

namespace isochor {
namespace {

// The axis that a vector lies along exactly, or -1.
int axis_of(const Vec3& v) {
  for (int a = 0; a < 3; ++a) {
    if (v[a] != 0.0 && v[(a + 1) % 3] == 0.0 && v[(a + 2) % 3] == 0.0) return a;
  }
  return -1;
}

bool perpendicular(const Vec3& a, const Vec3& b) {
  return std::abs(a.dot(b)) <= kSameDirection * a.norm() * b.norm();
}

std::string number(double value) {
  std::ostringstream text;
  text.precision(12);
  text << value;
  return text.str();
}

// A unit vector perpendicular to v.
Vec3 across(const Vec3& v) {
  int least = 0;
  v.cwiseAbs().minCoeff(&least);
  return (Vec3::Unit(least) - v * (v[least] / v.squaredNorm())).normalized();
}

// The direction that lies in all these planes and is nearest to `wish` (which it must not be
// perpendicular to); zero when there is none.
Vec3 direction_in(const std::vector<Vec3>& normals, const Vec3& wish) {
  if (std::all_of(normals.begin(), normals.end(),
                  [&](const Vec3& n) { return perpendicular(n, wish); })) {
    return wish;
  }
  const Vec3 first = normals.front();
  Vec3 line = Vec3::Zero();
  for (const Vec3& n : normals) {
    if (const Vec3 cross = first.cross(n); cross.norm() > line.norm()) line = cross;
  }
  const bool parallel = line.norm() <= kSameDirection;
  Vec3 found = parallel ? Vec3(wish - first * first.dot(wish)) : line;
  if (!(found.norm() > kSameDirection)) return Vec3::Zero();
  found.normalize();
  for (const Vec3& n : normals) {
    if (!perpendicular(n, found)) return Vec3::Zero();
  }
  if (perpendicular(found, wish)) return Vec3::Zero();
  return found.dot(wish) < 0.0 ? Vec3(-found) : found;
}

// How much a field is liked: its own bits, no shift, zero on a plane (errors of the boundary then
// count only by their square).
int merit(const FluxField& field, bool through_plane) {
  const bool axis = axis_of(field.direction) >= 0 && field.slope == field.direction;
  return (axis ? 8 : 0) + (through_plane ? 4 : 0) + (field.slope == field.direction ? 2 : 0) +
         (field.level == 0.0 ? 1 : 0);
}

std::vector<ClosingPlane> distinct(const std::vector<ClosingPlane>& planes) {
  std::vector<ClosingPlane> result;
  for (const ClosingPlane& plane : planes) {
    const bool known = std::any_of(result.begin(), result.end(), [&](const ClosingPlane& other) {
      return same_plane(plane, other);
    });
    if (!known) result.push_back(plane);
  }
  return result;
}

}  // namespace

ClosingPlane closing_plane(const Vec3& normal, double offset, const std::string& entity) {
  double length = normal.norm();
  if (!std::isfinite(length) || !(length > 0.0) || !std::isfinite(offset)) {
    throw InputError("", entity, "a plane needs a normal that is not zero, and a finite offset");
  }
  // A normal that was divided once keeps its digits: scripts stay as they are when written and
  // read.
  if (std::abs(length - 1.0) <= 8.0 * kUnitRoundoff) length = 1.0;
  ClosingPlane plane;
  const int axis = axis_of(normal);
  if (axis >= 0) {  // no rounding
    plane.normal = Vec3::Unit(axis);
    plane.offset = offset / normal[axis];
  } else {
    plane.normal = normal / length;
    plane.offset = offset / length;
  }
  if (plane.offset == 0.0) plane.offset = 0.0;  // not -0
  return plane;
}

ClosingPlane parse_closing_plane(const std::string& text) {
  const std::string entity = "the plane \"" + text + "\"";
  const auto fail = [&]() -> InputError {
    return InputError("", entity, "write it as \"y=0\", \"z=12.5\" or \"NX,NY,NZ,H\"");
  };
  const auto value_of = [&](const std::string& part) {
    char* end = nullptr;
    const double value = std::strtod(part.c_str(), &end);
    if (part.empty() || *end != '\0') throw fail();
    return value;
  };
  if (text.size() > 2 && text[1] == '=' && text[0] >= 'x' && text[0] <= 'z') {
    return closing_plane(Vec3::Unit(text[0] - 'x'), value_of(text.substr(2)), entity);
  }
  std::array<double, 4> values{};
  std::istringstream parts(text);
  std::string part;
  size_t count = 0;
  while (std::getline(parts, part, ',')) {
    if (count == values.size()) throw fail();
    values[count++] = value_of(part);
  }
  if (count != values.size()) throw fail();
  return closing_plane(Vec3(values[0], values[1], values[2]), values[3], entity);
}

std::string text_of(const ClosingPlane& plane) {
  std::string text;
  for (int a = 0; a < 3; ++a) {
    const double n = plane.normal[a];
    if (n == 0.0) continue;
    if (!text.empty()) text += n < 0.0 ? " - " : " + ";
    if (text.empty() && n < 0.0) text += "-";
    if (std::abs(n) != 1.0) text += number(std::abs(n)) + " ";
    text += static_cast<char>('x' + a);
  }
  return text + " = " + number(plane.offset);
}

std::string text_of(const std::vector<ClosingPlane>& planes) {
  std::string list;
  for (const ClosingPlane& plane : planes) list += (list.empty() ? "" : ", ") + text_of(plane);
  if (planes.size() == 1) return "the plane " + list;
  return std::to_string(planes.size()) + " planes (" + list + ")";
}

bool same_plane(const ClosingPlane& a, const ClosingPlane& b) {
  const double sign = a.normal.dot(b.normal) < 0.0 ? -1.0 : 1.0;
  const double scale = std::max(std::abs(a.offset), std::abs(b.offset));
  return (a.normal - sign * b.normal).norm() <= kSameDirection &&
         std::abs(a.offset - sign * b.offset) <= kSameDirection * scale;
}

std::optional<FluxField> field_without_flux(const std::vector<ClosingPlane>& given) {
  const std::vector<ClosingPlane> planes = distinct(given);
  if (planes.empty()) return FluxField{};
  std::optional<FluxField> best;
  int best_merit = -1;
  const auto offer = [&](const FluxField& field, bool through_plane) {
    const int value = merit(field, through_plane);
    if (value <= best_merit) return;
    best_merit = value;
    best = field;
  };
  std::vector<Vec3> all;
  for (const ClosingPlane& plane : planes) all.push_back(plane.normal);
  for (size_t k = 0; k < planes.size(); ++k) {
    std::vector<Vec3> others = all;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const Vec3& n = planes[k].normal;
    const Vec3 direction = others.empty() ? n : direction_in(others, n);
    const double along = n.dot(direction);
    if (!(along > 0.0)) continue;
    if (direction == n) {
      offer({n, n, planes[k].offset}, true);
    } else {
      offer({n / along, direction, planes[k].offset / along}, true);
    }
  }
  for (int a : {2, 0, 1}) {
    const Vec3 direction = direction_in(all, Vec3::Unit(a));
    if (direction != Vec3::Zero()) offer({direction, direction, 0.0}, false);
  }
  return best;
}

FluxField require_field(const std::vector<ClosingPlane>& planes) {
  const std::optional<FluxField> field = field_without_flux(planes);
  if (field) return *field;
  throw InputError("", "the closing planes " + text_of(planes),
                   "no direction lies in all of them but one, so no volume can be measured on "
                   "the skin alone: close the model by fewer planes, or cap it in your CAD");
}

std::optional<Vec3> common_point(const std::vector<ClosingPlane>& planes) {
  if (planes.empty()) return std::nullopt;
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(planes.size()), 3);
  Eigen::VectorXd offsets(rows.rows());
  double scale = 0.0;
  for (size_t k = 0; k < planes.size(); ++k) {
    rows.row(static_cast<Eigen::Index>(k)) = planes[k].normal.transpose();
    offsets[static_cast<Eigen::Index>(k)] = planes[k].offset;
    scale = std::max(scale, std::abs(planes[k].offset));
  }
  const Vec3 point = rows.completeOrthogonalDecomposition().solve(offsets);
  const double miss = (rows * point - offsets).cwiseAbs().maxCoeff();
  if (miss > kSameDirection * scale) return std::nullopt;
  return point;
}

FluxFrame::FluxFrame(const FluxField& field) : level_(field.level) {
  const Vec3& b = field.direction;
  const int axis = axis_of(b);
  const bool turned = axis >= 0 && b[axis] == 1.0 && field.slope == b;
  if (turned) {
    matrix_.setZero();
    for (int row = 0; row < 3; ++row) matrix_(row, (axis + 1 + row) % 3) = 1.0;
  } else {
    const Vec3 first = across(b);
    matrix_.row(0) = first;
    matrix_.row(1) = b.cross(first);
    matrix_.row(2) = field.slope;
  }
  plain_ = turned && axis == 2 && level_ == 0.0;
  exact_ = turned && level_ == 0.0;
}

Vec3 FluxFrame::point(const Vec3& x) const {
  Vec3 result = matrix_ * x;
  result.z() -= level_;
  return result;
}

std::vector<Vec3> FluxFrame::points(const std::vector<Vec3>& at) const {
  std::vector<Vec3> result(at.size());
  std::transform(at.begin(), at.end(), result.begin(), [&](const Vec3& x) { return point(x); });
  return result;
}

std::vector<Vec3> FluxFrame::directions(const std::vector<Vec3>& along) const {
  std::vector<Vec3> result(along.size());
  std::transform(along.begin(), along.end(), result.begin(),
                 [&](const Vec3& d) { return Vec3(matrix_ * d); });
  return result;
}

void FluxFrame::pull_back(std::vector<Vec3>& rows) const {
  if (plain_) return;
  for (Vec3& row : rows) row = matrix_.transpose() * row;
}

double FluxFrame::slip(const Vec3& x) const {
  if (exact_) return 0.0;
  // Three products, two sums and a difference, each rounded once.
  return 5.0 * kUnitRoundoff * ((matrix_.cwiseAbs() * x.cwiseAbs()).maxCoeff() + std::abs(level_));
}

}  // namespace isochor
