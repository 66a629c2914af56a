#include "isochor/step/part21_edit.h"

#include <charconv>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/step/part21_text.h"

namespace isochor::internal {

std::string step_real(double value) {
  ISOCHOR_REQUIRE(std::isfinite(value));
  char digits[40];
  const auto end = std::to_chars(digits, digits + sizeof digits, value);
  std::string text(digits, end.ptr);
  const size_t exponent = text.find('e');
  std::string mantissa = text.substr(0, exponent);
  if (mantissa.find('.') == std::string::npos) mantissa += '.';
  if (exponent == std::string::npos) return mantissa;
  size_t first = exponent + 1;
  const bool negative = text[first] == '-';
  if (negative || text[first] == '+') ++first;
  while (first + 1 < text.size() && text[first] == '0') ++first;
  return mantissa + (negative ? "E-" : "E") + text.substr(first);
}

void Part21Edit::replace(const Part21Instance& instance, const TextSpan& span, std::string text) {
  ISOCHOR_REQUIRE(
      instance.body.begin <= span.begin && span.begin < span.end && span.end <= instance.body.end,
      span.begin, span.end);
  const auto after = replacements_.lower_bound(span.begin);
  if (after != replacements_.end()) {
    const bool same = after->first == span.begin && after->second.end == span.end;
    ISOCHOR_REQUIRE(same || after->first >= span.end, span.begin, after->first);
  }
  if (after != replacements_.begin()) {
    ISOCHOR_REQUIRE(std::prev(after)->second.end <= span.begin, span.begin);
  }
  replacements_[span.begin] = {span.end, std::move(text)};
  changed_.insert(instance.number);
}

void Part21Edit::repoint(const Part21Instance& instance, const Part21Value& reference,
                         std::uint64_t to) {
  ISOCHOR_REQUIRE(reference.is(Part21Kind::kReference));
  if (reference.reference == to && replacements_.count(reference.span.begin) == 0) return;
  replace(instance, reference.span, "#" + std::to_string(to));
}

namespace {

// Copies of instances may have line breaks between their values; in strings they stay.
std::string in_one_line(const std::string& body) {
  std::string line;
  bool quoted = false;
  for (char c : body) {
    if (c == '\'') quoted = !quoted;
    if (quoted || (c != '\n' && c != '\r')) line += c;
  }
  return line;
}

}  // namespace

std::uint64_t Part21Edit::append(const Part21Instance& beside, const std::string& body) {
  ISOCHOR_REQUIRE(beside.section < appended_.size(), beside.section);
  appended_[beside.section] +=
      "#" + std::to_string(next_) + "=" + in_one_line(body) + ";" + file_.line_ending();
  ++count_;
  return next_++;
}

void Part21Edit::remove(const Part21Instance& instance) {
  const std::string& old = file_.text();
  size_t begin = instance.span.begin, end = instance.span.end;
  const auto next = replacements_.lower_bound(begin);
  ISOCHOR_REQUIRE(next == replacements_.end() || next->first >= end, instance.number);
  const bool starts_line = begin == 0 || old[begin - 1] == '\n' || old[begin - 1] == '\r';
  const std::string& ending = file_.line_ending();
  if (starts_line && old.compare(end, ending.size(), ending) == 0) end += ending.size();
  replacements_[begin] = {end, ""};
  changed_.insert(instance.number);
}

std::string Part21Edit::text() const {
  const std::string& old = file_.text();
  std::string out;
  out.reserve(old.size() + old.size() / 8);
  size_t copied = 0;
  const auto copy_to = [&](size_t end) {
    for (auto it = replacements_.lower_bound(copied); it != replacements_.end() && it->first < end;
         ++it) {
      out.append(old, copied, it->first - copied);
      out += it->second.text;
      copied = it->second.end;
    }
    out.append(old, copied, end - copied);
    copied = end;
  };
  for (size_t k = 0; k < appended_.size(); ++k) {
    if (appended_[k].empty()) continue;
    // ENDSEC may be indented; new lines stand before its line, or on lines of their own when
    // something else is on it.
    size_t at = file_.sections()[k].endsec;
    while (at > 0 && (old[at - 1] == ' ' || old[at - 1] == '\t')) --at;
    const bool own_line = at == 0 || old[at - 1] == '\n' || old[at - 1] == '\r';
    if (!own_line) at = file_.sections()[k].endsec;
    copy_to(at);
    if (!own_line) out += file_.line_ending();
    out += appended_[k];
  }
  copy_to(old.size());
  return out;
}

}  // namespace isochor::internal
