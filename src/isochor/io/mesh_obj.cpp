#include "isochor/io/mesh_obj.h"

#include <charconv>

#include "isochor/io/file.h"

namespace isochor {
namespace {

void add_number(std::string& text, double value) {
  char digits[40];
  const auto result = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, result.ptr);
}

void add_vector(std::string& text, const char* keyword, const Vec3& p) {
  text += keyword;
  for (int c = 0; c < 3; ++c) {
    text += ' ';
    add_number(text, p[c]);
  }
  text += '\n';
}

std::string group_name(int group, const std::vector<std::string>& names) {
  const auto at = static_cast<size_t>(group);
  if (group < 0 || at >= names.size() || names[at].empty()) {
    return "group_" + std::to_string(group);
  }
  std::string name = names[at];
  for (char& c : name) {
    if (static_cast<unsigned char>(c) <= ' ' || c == 0x7F) c = '_';
  }
  return name;
}

}  // namespace

std::string obj_text(const Mesh& mesh, const std::vector<std::string>& group_names) {
  require_usable(mesh);
  std::string text = "# Isochor\n";
  for (const Vec3& p : mesh.positions) add_vector(text, "v", p);
  for (const Vec3& n : mesh.normals) add_vector(text, "vn", n);
  for (size_t k = 0; k < mesh.triangles.size(); ++k) {
    if (!mesh.groups.empty() && (k == 0 || mesh.groups[k] != mesh.groups[k - 1])) {
      text += "g " + group_name(mesh.groups[k], group_names) + '\n';
    }
    text += 'f';
    for (int i : mesh.triangles[k]) {
      const std::string number = std::to_string(i + 1);
      text += ' ' + number;
      if (!mesh.normals.empty()) text += "//" + number;
    }
    text += '\n';
  }
  return text;
}

void write_obj(const std::string& path, const Mesh& mesh,
               const std::vector<std::string>& group_names) {
  write_file(path, obj_text(mesh, group_names));
}

}  // namespace isochor
