// An output file that appears complete or not at all. Internal to `step`.
//
// The data are written to a temporary file in the same folder, which is renamed at the end: readers
// never see half a file, and a failure leaves an older output as it was.
#pragma once

#include <string>

namespace isochor::internal {

class OutputFile {
 public:
  // The temporary name keeps the ending of `path`, because the format goes by it.
  // Throws InputError when the folder does not exist.
  explicit OutputFile(std::string path);
  // Removes the temporary file unless committed.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::string& temporary() const { return temporary_; }
  // Puts the file in its place. Throws InputError when that fails.
  void commit();

 private:
  std::string path_;
  std::string temporary_;
};

}  // namespace isochor::internal
