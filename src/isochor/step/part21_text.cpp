#include "isochor/step/part21_text.h"

namespace isochor::internal {
namespace {

// Numbers of instances fit 64 bits with room for new ones.
constexpr size_t kMostDigits = 18;

}  // namespace

void TextCursor::skip_blanks() {
  while (at < end) {
    if (is_blank(text[at])) {
      ++at;
    } else if (text[at] == '/' && at + 1 < end && text[at + 1] == '*') {
      const size_t close = text.find("*/", at + 2);
      if (close == std::string_view::npos || close + 2 > end) {
        defect = "a comment is not closed";
        return;
      }
      at = close + 2;
    } else {
      return;
    }
  }
}

void TextCursor::skip_quoted() {
  const char quote = text[at];
  size_t look = at + 1;
  for (;;) {
    const size_t close = text.find(quote, look);
    if (close == std::string_view::npos || close >= end) {
      defect = "a string is not closed";
      return;
    }
    look = close + 1;
    if (quote == '\'' && look < end && text[look] == quote) {
      ++look;  // '' is one apostrophe inside
      continue;
    }
    at = look;
    return;
  }
}

std::string_view TextCursor::word() {
  const size_t begin = at;
  size_t look = at;
  if (look < end && text[look] == '!') ++look;
  if (look >= end || !(is_letter(text[look]) || text[look] == '_')) return {};
  while (look < end && is_word(text[look])) ++look;
  at = look;
  return text.substr(begin, look - begin);
}

std::uint64_t TextCursor::instance_number() {
  const size_t begin = at;
  while (begin < end && at < end && text[at] == '0') ++at;
  const size_t digits = at;
  std::uint64_t value = 0;
  while (at < end && is_digit(text[at])) {
    if (at - digits >= kMostDigits) {
      at = begin;
      defect = "an instance number has too many digits";
      return 0;
    }
    value = value * 10 + static_cast<std::uint64_t>(text[at++] - '0');
  }
  if (at == begin) defect = "'#' is not followed by a number";
  return value;
}

}  // namespace isochor::internal
