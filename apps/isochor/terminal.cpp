#include "terminal.h"

#include <cstdio>
#include <vector>

namespace isochor::app {

void print(const Common& common, const std::string& line) {
  if (!common.json && !common.quiet) std::printf("%s\n", line.c_str());
}

void print_json(const Common& common, const Value& value) {
  if (common.json) std::fputs(to_json(value).c_str(), stdout);
}

void refuse(const std::string& line) { std::fprintf(stderr, "isochor: %s\n", line.c_str()); }

void note(const Common& common, const std::string& line) {
  if (!common.quiet) std::fprintf(stderr, "isochor: %s\n", line.c_str());
}

void detail(const Common& common, const std::string& line) {
  if (common.verbose) note(common, line);
}

std::string format(const char* pattern, ...) {
  va_list arguments;
  va_start(arguments, pattern);
  va_list again;
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, pattern, arguments);
  va_end(arguments);
  std::vector<char> text(static_cast<size_t>(length) + 1);
  std::vsnprintf(text.data(), text.size(), pattern, again);
  va_end(again);
  return std::string(text.data(), static_cast<size_t>(length));
}

}  // namespace isochor::app
