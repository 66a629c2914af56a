#include "isochor/io/mesh_glb.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/io/file.h"
#include "isochor/io/little_endian.h"

namespace isochor {
namespace {

using internal::add_bytes;
using internal::add_float;

// Constants of the format.
constexpr int kFloat = 5126, kUnsignedInt = 5125, kUnsignedShort = 5123;
constexpr int kVertexBuffer = 34962, kIndexBuffer = 34963;
constexpr int kLines = 1, kTriangles = 4;
constexpr std::uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;

template <typename T>
std::string number(T value) {
  char digits[40];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

template <typename Vector>
std::string list(const Vector& v) {
  return '[' + number(v[0]) + ',' + number(v[1]) + ',' + number(v[2]) + ']';
}

void add_item(std::string& items, const std::string& item) {
  if (!items.empty()) items += ',';
  items += item;
}

Vec3 upright(const Vec3& v) { return {v.x(), v.z(), -v.y()}; }

// Collects the binary chunk and the JSON lists that describe it.
class GlbBuilder {
 public:
  explicit GlbBuilder(const GlbOptions& options, const Vec3& middle)
      : options_(options), middle_(middle) {}

  void add_mesh(const Mesh& mesh) {
    std::string attributes = "\"POSITION\":" + number(add_positions(mesh.positions));
    if (!mesh.normals.empty()) {
      begin_view(kVertexBuffer);
      for (const Vec3& n : mesh.normals) add_vector(upright(n).cast<float>());
      attributes += ",\"NORMAL\":" + number(end_view(kFloat, "VEC3", mesh.normals.size(), ""));
    }
    if (!options_.colours.empty()) attributes += ",\"COLOR_0\":" + number(add_colours());
    begin_view(kIndexBuffer);
    for (const auto& t : mesh.triangles) {
      for (int i : t) add_bytes(binary_, static_cast<std::uint32_t>(i), 4);
    }
    const int indices = end_view(kUnsignedInt, "SCALAR", 3 * mesh.triangles.size(), "");
    const std::array<double, 3> white = {1.0, 1.0, 1.0};
    add_primitive(attributes, indices, kTriangles,
                  options_.colours.empty() ? options_.colour : white);
  }

  void add_lines(const LineSet& lines) {
    if (lines.empty()) return;
    const std::string attributes = "\"POSITION\":" + number(add_positions(lines.points));
    begin_view(kIndexBuffer);
    for (const auto& s : lines.segments) {
      for (int i : s) add_bytes(binary_, static_cast<std::uint32_t>(i), 4);
    }
    const int indices = end_view(kUnsignedInt, "SCALAR", 2 * lines.segments.size(), "");
    std::array<double, 3> linear = lines.colour;
    for (double& c : linear) c = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    add_primitive(attributes, indices, kLines, linear);
  }

  std::string bytes() const {
    std::string json =
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"Isochor\"},\"scene\":0,"
        "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"translation\":" +
        list(Vec3(options_.metres_per_unit * upright(middle_))) +
        "}],\"meshes\":[{\"primitives\":[" + primitives_ + "]}],\"materials\":[" + materials_ +
        "],\"accessors\":[" + accessors_ + "],\"bufferViews\":[" + views_ +
        "],\"buffers\":[{\"byteLength\":" + number(binary_.size()) + "}]}";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string out;
    add_bytes(out, kMagic, 4);
    add_bytes(out, 2, 4);
    add_bytes(out, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary_.size()), 4);
    add_bytes(out, static_cast<std::uint32_t>(json.size()), 4);
    add_bytes(out, kJsonChunk, 4);
    out += json;
    add_bytes(out, static_cast<std::uint32_t>(binary_.size()), 4);
    add_bytes(out, kBinChunk, 4);
    return out + binary_;
  }

 private:
  void add_vector(const Eigen::Vector3f& v) {
    for (int c = 0; c < 3; ++c) add_float(binary_, v[c]);
  }

  int add_positions(const std::vector<Vec3>& positions) {
    begin_view(kVertexBuffer);
    Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
    Eigen::Vector3f high = -low;
    for (const Vec3& p : positions) {
      const Eigen::Vector3f at =
          (options_.metres_per_unit * upright(p - middle_)).eval().cast<float>();
      add_vector(at);
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
    return end_view(kFloat, "VEC3", positions.size(),
                    ",\"min\":" + list(low) + ",\"max\":" + list(high));
  }

  int add_colours() {
    begin_view(kVertexBuffer);
    for (const auto& colour : options_.colours) {
      for (double c : colour) {
        add_bytes(binary_,
                  static_cast<std::uint32_t>(std::lround(65535.0 * std::clamp(c, 0.0, 1.0))), 2);
      }
      add_bytes(binary_, 65535, 2);
    }
    return end_view(kUnsignedShort, "VEC4", options_.colours.size(), ",\"normalized\":true");
  }

  void begin_view(int target) {
    view_begin_ = binary_.size();
    view_target_ = target;
  }
  // Returns the number of the accessor. All items are multiples of four bytes: nothing to pad.
  int end_view(int component, const char* type, size_t count, const std::string& more) {
    add_item(views_, "{\"buffer\":0,\"byteOffset\":" + number(view_begin_) +
                         ",\"byteLength\":" + number(binary_.size() - view_begin_) +
                         ",\"target\":" + number(view_target_) + '}');
    add_item(accessors_,
             "{\"bufferView\":" + number(view_count_) + ",\"componentType\":" + number(component) +
                 ",\"count\":" + number(count) + ",\"type\":\"" + type + '"' + more + '}');
    return view_count_++;
  }

  void add_primitive(const std::string& attributes, int indices, int mode,
                     const std::array<double, 3>& colour) {
    add_item(primitives_, "{\"attributes\":{" + attributes + "},\"indices\":" + number(indices) +
                              ",\"material\":" + number(material_count_++) +
                              ",\"mode\":" + number(mode) + '}');
    add_item(materials_, "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[" + number(colour[0]) +
                             ',' + number(colour[1]) + ',' + number(colour[2]) +
                             ",1],\"metallicFactor\":0,\"roughnessFactor\":0.75},"
                             "\"doubleSided\":true}");
  }

  const GlbOptions& options_;
  const Vec3 middle_;
  std::string binary_, primitives_, materials_, accessors_, views_;
  size_t view_begin_ = 0;
  int view_target_ = 0, view_count_ = 0, material_count_ = 0;
};

}  // namespace

std::optional<double> metres_per_unit(const std::string& unit) {
  static const std::map<std::string, double> known = {
      {"m", 1.0},       {"metre", 1.0},     {"mm", 1e-3},     {"cm", 1e-2},     {"dm", 0.1},
      {"km", 1e3},      {"um", 1e-6},       {"µm", 1e-6},     {"nm", 1e-9},     {"in", 0.0254},
      {"inch", 0.0254}, {"ft", 0.3048},     {"foot", 0.3048}, {"feet", 0.3048}, {"yd", 0.9144},
      {"yard", 0.9144}, {"mile", 1609.344}, {"mil", 2.54e-5}};
  const auto found = known.find(unit);
  if (found == known.end()) return std::nullopt;
  return found->second;
}

std::string glb_bytes(const Mesh& mesh, const std::vector<LineSet>& lines,
                      const GlbOptions& options) {
  require_usable(mesh);
  ISOCHOR_REQUIRE(!mesh.empty());
  ISOCHOR_REQUIRE(options.metres_per_unit > 0.0 && std::isfinite(options.metres_per_unit),
                  options.metres_per_unit);
  ISOCHOR_REQUIRE(options.colours.empty() || options.colours.size() == mesh.positions.size(),
                  options.colours.size(), mesh.positions.size());
  GlbBuilder builder(options, bounding_box(mesh).centre());
  builder.add_mesh(mesh);
  for (const LineSet& set : lines) {
    require_usable(set);
    builder.add_lines(set);
  }
  return builder.bytes();
}

void write_glb(const std::string& path, const Mesh& mesh, const std::vector<LineSet>& lines,
               const GlbOptions& options) {
  write_file(path, glb_bytes(mesh, lines, options));
}

}  // namespace isochor
