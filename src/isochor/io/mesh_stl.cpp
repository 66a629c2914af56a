#include "isochor/io/mesh_stl.h"

#include <cmath>
#include <limits>

#include "isochor/base/error.h"
#include "isochor/io/file.h"
#include "isochor/io/little_endian.h"

namespace isochor {
namespace {

constexpr size_t kHeaderSize = 80;

void add_vector(std::string& bytes, const Eigen::Vector3f& v) {
  for (int c = 0; c < 3; ++c) internal::add_float(bytes, v[c]);
}

}  // namespace

std::string stl_bytes(const Mesh& mesh) {
  require_usable(mesh);
  ISOCHOR_REQUIRE(mesh.triangles.size() <= std::numeric_limits<std::uint32_t>::max(),
                  mesh.triangles.size());
  for (const Vec3& p : mesh.positions) {
    ISOCHOR_REQUIRE(p.cwiseAbs().maxCoeff() <= std::numeric_limits<float>::max(), p.transpose());
  }
  // Not beginning with "solid": that would announce the text form.
  std::string bytes = "Isochor, binary STL";
  bytes.resize(kHeaderSize, ' ');
  bytes.reserve(kHeaderSize + 4 + 50 * mesh.triangles.size());
  internal::add_bytes(bytes, static_cast<std::uint32_t>(mesh.triangles.size()), 4);
  for (const auto& t : mesh.triangles) {
    Vec3 corner[3];
    for (size_t k = 0; k < 3; ++k) corner[k] = mesh.positions[static_cast<size_t>(t[k])];
    const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double length = normal.norm();
    add_vector(bytes, length > 0.0 && std::isfinite(length)
                          ? Eigen::Vector3f((normal / length).cast<float>())
                          : Eigen::Vector3f(Eigen::Vector3f::Zero()));
    for (const Vec3& p : corner) add_vector(bytes, p.cast<float>());
    internal::add_bytes(bytes, 0, 2);
  }
  return bytes;
}

void write_stl(const std::string& path, const Mesh& mesh) { write_file(path, stl_bytes(mesh)); }

}  // namespace isochor
