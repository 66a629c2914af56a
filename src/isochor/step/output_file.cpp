#include "isochor/step/output_file.h"

#include <unistd.h>

#include <atomic>
#include <filesystem>

#include "isochor/base/error.h"

namespace isochor::internal {
namespace fs = std::filesystem;

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
  static std::atomic<unsigned> count{0};
  const fs::path target(path_);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  std::error_code fault;
  if (!fs::is_directory(folder, fault)) {
    throw InputError(path_, "", "the folder '" + folder.string() + "' does not exist");
  }
  if (fs::is_directory(target, fault)) throw InputError(path_, "", "is a folder, not a file");
  const std::string name = "." + target.stem().string() + "." + std::to_string(getpid()) + "." +
                           std::to_string(++count) + target.extension().string();
  temporary_ = (folder / name).string();
}

OutputFile::~OutputFile() {
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void OutputFile::commit() {
  std::error_code fault;
  fs::rename(temporary_, path_, fault);
  if (fault) throw InputError(path_, "", "cannot be written: " + fault.message());
}

}  // namespace isochor::internal
