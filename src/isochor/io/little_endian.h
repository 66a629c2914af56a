// Numbers as bytes, least significant first, whatever the machine.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace isochor::internal {

inline void add_bytes(std::string& bytes, std::uint32_t value, int count) {
  for (int k = 0; k < count; ++k) bytes += static_cast<char>((value >> (8 * k)) & 0xFFu);
}

inline void add_float(std::string& bytes, float value) {
  std::uint32_t pattern = 0;
  static_assert(sizeof pattern == sizeof value);
  std::memcpy(&pattern, &value, sizeof pattern);
  add_bytes(bytes, pattern, 4);
}

}  // namespace isochor::internal
