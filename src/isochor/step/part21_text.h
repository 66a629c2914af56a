// The letters of ISO 10303-21: blanks, comments, words. Internal to `step`; no OpenCASCADE.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace isochor::internal {

inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
inline bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
inline bool is_word(char c) { return is_digit(c) || is_letter(c) || c == '_'; }
inline bool is_blank(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\f' || c == '\v';
}

// A place in a text. Functions that move it report defects by `defect`, which is null while there
// is none; then `at` is where it was found.
struct TextCursor {
  std::string_view text;
  size_t at = 0;
  size_t end = 0;  // behind the last byte that may be looked at
  const char* defect = nullptr;

  bool done() const { return at >= end; }
  char peek() const { return at < end ? text[at] : '\0'; }
  bool take(char c) {
    if (peek() != c || done()) return false;
    ++at;
    return true;
  }
  // To the next byte that is neither blank nor comment.
  void skip_blanks();
  // From an opening quote (' or ") behind the closing one.
  void skip_quoted();
  // A keyword, perhaps with '!' before it; empty when there is none.
  std::string_view word();
  // The digits of an instance number; zero and a defect when they are none or too many.
  std::uint64_t instance_number();
};

}  // namespace isochor::internal
