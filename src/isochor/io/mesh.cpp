#include "isochor/io/mesh.h"

#include "isochor/base/error.h"

namespace isochor {
namespace {

size_t at(int index) { return static_cast<size_t>(index); }

// Twice the vector area.
Vec3 double_area(const Mesh& mesh, const std::array<int, 3>& t) {
  const Vec3& a = mesh.positions[at(t[0])];
  return (mesh.positions[at(t[1])] - a).cross(mesh.positions[at(t[2])] - a);
}

template <typename T>
bool keeps_values(const std::vector<T>& whole, const std::vector<T>& part, bool was_empty) {
  return !part.empty() && (was_empty || !whole.empty());
}

}  // namespace

void LineSet::add(const std::vector<Vec3>& line) {
  const auto first = static_cast<int>(points.size());
  points.insert(points.end(), line.begin(), line.end());
  for (int i = 1; i < static_cast<int>(line.size()); ++i) {
    segments.push_back({first + i - 1, first + i});
  }
}

void require_usable(const Mesh& mesh) {
  const size_t count = mesh.positions.size();
  ISOCHOR_REQUIRE(mesh.normals.empty() || mesh.normals.size() == count, mesh.normals.size(), count);
  ISOCHOR_REQUIRE(mesh.scalars.empty() || mesh.scalars.size() == count, mesh.scalars.size(), count);
  ISOCHOR_REQUIRE(mesh.groups.empty() || mesh.groups.size() == mesh.triangles.size(),
                  mesh.groups.size(), mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (int i : triangle) ISOCHOR_REQUIRE(i >= 0 && at(i) < count, i, count);
  }
  for (const Vec3& p : mesh.positions) ISOCHOR_REQUIRE(p.allFinite(), p.transpose());
}

void require_usable(const LineSet& lines) {
  for (const auto& segment : lines.segments) {
    for (int i : segment) {
      ISOCHOR_REQUIRE(i >= 0 && at(i) < lines.points.size(), i, lines.points.size());
    }
  }
  for (const Vec3& p : lines.points) ISOCHOR_REQUIRE(p.allFinite(), p.transpose());
}

void append(Mesh& mesh, const Mesh& part, int group) {
  const bool was_empty = mesh.positions.empty();
  const auto offset = static_cast<int>(mesh.positions.size());
  if (keeps_values(mesh.normals, part.normals, was_empty)) {
    mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  } else {
    mesh.normals.clear();
  }
  if (keeps_values(mesh.scalars, part.scalars, was_empty)) {
    mesh.scalars.insert(mesh.scalars.end(), part.scalars.begin(), part.scalars.end());
  } else {
    mesh.scalars.clear();
  }
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.groups.resize(mesh.triangles.size(), 0);
  for (size_t k = 0; k < part.triangles.size(); ++k) {
    const auto& t = part.triangles[k];
    mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    mesh.groups.push_back(part.groups.empty() ? group : part.groups[k]);
  }
}

void complete_normals(Mesh& mesh) {
  std::vector<Vec3> averages(mesh.positions.size(), Vec3::Zero());
  for (const auto& t : mesh.triangles) {
    const Vec3 weighted = double_area(mesh, t);
    for (int i : t) averages[at(i)] += weighted;
  }
  mesh.normals.resize(mesh.positions.size(), Vec3::Zero());
  for (size_t i = 0; i < averages.size(); ++i) {
    if (mesh.normals[i].squaredNorm() > 0.0) continue;
    const double length = averages[i].norm();
    mesh.normals[i] = length > 0.0 ? Vec3(averages[i] / length) : Vec3(Vec3::UnitZ());
  }
}

double area(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) sum += double_area(mesh, t).norm();
  return 0.5 * sum;
}

double enclosed_volume(const Mesh& mesh) {
  if (mesh.triangles.empty()) return 0.0;
  // Measured from a point of the mesh: far from the origin the terms would cancel.
  const Vec3 origin = mesh.positions[at(mesh.triangles.front()[0])];
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.positions[at(t[0])] - origin;
    const Vec3 b = mesh.positions[at(t[1])] - origin;
    const Vec3 c = mesh.positions[at(t[2])] - origin;
    sum += a.dot(b.cross(c));
  }
  return sum / 6.0;
}

Box bounding_box(const Mesh& mesh) {
  Box box;
  for (const auto& t : mesh.triangles) {
    for (int i : t) box.add(mesh.positions[at(i)]);
  }
  return box;
}

}  // namespace isochor
