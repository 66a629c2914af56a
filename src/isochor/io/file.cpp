#include "isochor/io/file.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "isochor/base/error.h"

namespace isochor {
namespace fs = std::filesystem;

std::string read_file(const std::string& path) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (!fs::exists(status)) throw InputError(path, "", "no such file");
  if (fs::is_directory(status)) throw InputError(path, "", "is a directory");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path, "", std::string("cannot be opened: ") + std::strerror(errno));
  std::ostringstream content;
  content << in.rdbuf();
  if (in.bad()) throw InputError(path, "", "cannot be read");
  return content.str();
}

std::string temporary_path_beside(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  const fs::path target(path);
  const std::string name = ".isochor-" + std::to_string(::getpid()) + "-" +
                           std::to_string(counter++) + "-" + target.filename().string();
  return (target.parent_path() / name).string();
}

void move_into_place(const std::string& temporary, const std::string& path) {
  std::error_code code;
  fs::rename(temporary, path, code);
  if (code) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw InputError(path, "", "cannot be written: " + code.message());
  }
}

void require_writable(const std::string& path) {
  if (fs::is_directory(path)) throw InputError(path, "", "is a directory");
  const std::string temporary = temporary_path_beside(path);
  const bool made = std::ofstream(temporary, std::ios::binary).good();
  const std::string why = std::strerror(errno);
  std::error_code ignored;
  fs::remove(temporary, ignored);
  if (!made) throw InputError(path, "", "cannot be written: " + why);
}

void write_file(const std::string& path, std::string_view content) {
  const std::string temporary = temporary_path_beside(path);
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.flush();
    if (!out) {
      const std::string why = std::strerror(errno);
      std::error_code ignored;
      fs::remove(temporary, ignored);
      throw InputError(path, "", "cannot be written: " + why);
    }
  }
  move_into_place(temporary, path);
}

std::string extension_of(const std::string& path) {
  std::string name = fs::path(path).filename().string();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::string model = "isochor.json";
  if (name.size() >= model.size() &&
      name.compare(name.size() - model.size(), model.size(), model) == 0) {
    return model;
  }
  const size_t dot = name.rfind('.');
  return dot == std::string::npos ? "" : name.substr(dot + 1);
}

}  // namespace isochor
