// What each target offers, in libFuzzer's words, and what it may say.
//
// A target feeds any bytes to one reader. The reader may refuse them by an InputError; whatever
// else it throws, and each broken promise, ends the program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace isochor::fuzz {

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// How many inputs were accepted: seeds that are all refused would test nothing.
inline long accepted = 0;

// Ends the program when a promise is broken.
inline void promise(bool kept, const char* what) {
  if (kept) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

}  // namespace isochor::fuzz
