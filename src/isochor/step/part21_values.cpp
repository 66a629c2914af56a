// The arguments of one instance.
#include <charconv>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/step/part21.h"
#include "isochor/step/part21_text.h"

namespace isochor::internal {
namespace {

// Schemas nest lists three deep; this leaves room and saves the stack.
constexpr int kDeepest = 64;

// Points have three coordinates, most entities four arguments or fewer.
constexpr size_t kUsualItems = 4;

class Parser {
 public:
  Parser(const Part21File& file, const Part21Instance& instance)
      : file_(file), cursor_{file.text(), instance.body.begin, instance.body.end} {}

  std::vector<Part21Record> records() {
    std::vector<Part21Record> parts;
    if (cursor_.take('(')) {
      for (blanks(); !cursor_.take(')'); blanks()) parts.push_back(record());
      if (parts.empty()) file_.refuse(cursor_.at, "a complex instance has no parts");
    } else {
      parts.push_back(record());
    }
    blanks();
    if (!cursor_.done()) refuse("something follows the last parenthesis");
    return parts;
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) { file_.refuse(cursor_.at, reason); }
  void check() {
    if (cursor_.defect != nullptr) refuse(cursor_.defect);
  }
  void blanks() {
    cursor_.skip_blanks();
    check();
  }

  Part21Record record() {
    Part21Record result;
    result.span.begin = cursor_.at;
    result.keyword = cursor_.word();
    if (result.keyword.empty()) refuse("a keyword is missing");
    blanks();
    result.arguments = list(0);
    result.span.end = cursor_.at;
    return result;
  }

  std::vector<Part21Value> list(int depth) {
    if (depth >= kDeepest) refuse("lists are nested too deeply");
    if (!cursor_.take('(')) refuse("'(' is missing");
    std::vector<Part21Value> values;
    blanks();
    if (cursor_.take(')')) return values;
    values.reserve(kUsualItems);
    for (;;) {
      blanks();
      values.push_back(value(depth));
      blanks();
      if (cursor_.take(')')) return values;
      if (!cursor_.take(',')) refuse("',' or ')' is missing");
    }
  }

  Part21Value value(int depth) {
    Part21Value v;
    v.span.begin = cursor_.at;
    switch (cursor_.peek()) {
      case '#':
        v.kind = Part21Kind::kReference;
        ++cursor_.at;
        v.reference = cursor_.instance_number();
        check();
        break;
      case '\'':
      case '"':
        v.kind = cursor_.peek() == '"' ? Part21Kind::kBinary : Part21Kind::kString;
        cursor_.skip_quoted();
        check();
        break;
      case '.':
        enumeration(v);
        break;
      case '(':
        v.kind = Part21Kind::kList;
        v.items = list(depth + 1);
        break;
      case '$':
        ++cursor_.at;
        break;
      case '*':
        v.kind = Part21Kind::kDerived;
        ++cursor_.at;
        break;
      default:
        number_or_typed(v, depth);
    }
    v.span.end = cursor_.at;
    return v;
  }

  void enumeration(Part21Value& v) {
    v.kind = Part21Kind::kEnumeration;
    ++cursor_.at;
    v.word = cursor_.word();
    if (v.word.empty() || !cursor_.take('.')) refuse("an enumeration is not closed by '.'");
  }

  void number_or_typed(Part21Value& v, int depth) {
    const char c = cursor_.peek();
    if (is_digit(c) || c == '-' || c == '+') return number(v);
    v.kind = Part21Kind::kTyped;
    v.word = cursor_.word();
    if (v.word.empty()) refuse("a value is missing");
    blanks();
    v.items = list(depth + 1);
  }

  void digits() {
    while (is_digit(cursor_.peek())) ++cursor_.at;
  }

  void number(Part21Value& v) {
    const size_t begin = cursor_.at;
    if (!cursor_.take('-')) cursor_.take('+');
    if (!is_digit(cursor_.peek())) refuse("a number has no digits");
    v.kind = Part21Kind::kInteger;
    digits();
    if (cursor_.take('.')) {
      v.kind = Part21Kind::kReal;
      digits();
    }
    if (cursor_.peek() == 'E' || cursor_.peek() == 'e') {
      v.kind = Part21Kind::kReal;
      ++cursor_.at;
      if (!cursor_.take('-')) cursor_.take('+');
      if (!is_digit(cursor_.peek())) refuse("an exponent has no digits");
      digits();
    }
    std::string_view text = file_.text({begin, cursor_.at});
    if (text.front() == '+') text.remove_prefix(1);
    const auto got = std::from_chars(text.data(), text.data() + text.size(), v.number);
    if (got.ec == std::errc::result_out_of_range) {
      const size_t exponent = text.find_first_of("Ee");
      const bool tiny = exponent != std::string_view::npos && text[exponent + 1] == '-';
      if (!tiny) {
        cursor_.at = begin;
        refuse("the number " + std::string(text.substr(0, 40)) + " is too large");
      }
      v.number = 0.0;
    }
  }

  const Part21File& file_;
  TextCursor cursor_;
};

void append_utf8(std::string& out, std::uint32_t code) {
  const auto add = [&](std::uint32_t byte) { out.push_back(static_cast<char>(byte)); };
  if (code < 0x80) {
    add(code);
  } else if (code < 0x800) {
    add(0xC0 | (code >> 6));
    add(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    add(0xE0 | (code >> 12));
    add(0x80 | ((code >> 6) & 0x3F));
    add(0x80 | (code & 0x3F));
  } else {
    add(0xF0 | ((code >> 18) & 0x07));
    add(0x80 | ((code >> 12) & 0x3F));
    add(0x80 | ((code >> 6) & 0x3F));
    add(0x80 | (code & 0x3F));
  }
}

// The hexadecimal number of `digits` digits at the start of `text`, or nothing.
bool hexadecimal(std::string_view text, size_t digits, std::uint32_t& value) {
  if (text.size() < digits) return false;
  const auto got = std::from_chars(text.data(), text.data() + digits, value, 16);
  return got.ec == std::errc() && got.ptr == text.data() + digits;
}

// Decodes the directive at the start of `text`, a backslash; returns the bytes it takes, or 0 when
// it is none.
size_t directive(std::string_view text, std::string& out) {
  std::uint32_t code = 0;
  if (text.substr(0, 2) == "\\\\") {
    out.push_back('\\');
    return 2;
  }
  if (text.substr(0, 3) == "\\X\\" && hexadecimal(text.substr(3), 2, code)) {
    append_utf8(out, code);
    return 5;
  }
  if (text.substr(0, 3) == "\\S\\" && text.size() > 3) {
    append_utf8(out, (static_cast<unsigned char>(text[3]) & 0x7Fu) + 0x80u);
    return 4;
  }
  if (text.size() > 3 && text[1] == 'P' && text[3] == '\\') return 4;  // an alphabet: Latin here
  if (text.substr(0, 4) != "\\X2\\" && text.substr(0, 4) != "\\X4\\") return 0;
  const size_t digits = text[2] == '2' ? 4 : 8;
  size_t at = 4;
  std::uint32_t high = 0;
  for (; hexadecimal(text.substr(at), digits, code); at += digits) {
    if (code >= 0xD800 && code < 0xDC00) {
      high = code;  // UTF-16 in two parts
      continue;
    }
    if (code >= 0xDC00 && code < 0xE000 && high != 0) {
      code = 0x10000 + ((high - 0xD800) << 10) + (code - 0xDC00);
    }
    high = 0;
    append_utf8(out, code);
  }
  return text.substr(at, 4) == "\\X0\\" ? at + 4 : at;
}

}  // namespace

std::vector<Part21Record> Part21File::records(const Part21Instance& instance) const {
  return Parser(*this, instance).records();
}

Part21Record Part21File::record(const Part21Instance& instance, std::string_view keyword) const {
  for (auto& part : records(instance)) {
    if (part.keyword == keyword) return std::move(part);
  }
  refuse(instance.span.begin,
         "#" + std::to_string(instance.number) + " is no " + std::string(keyword));
}

bool Part21File::is_a(const Part21Instance& instance, std::string_view keyword) const {
  if (!instance.complex()) return instance.keyword == keyword;
  for (const auto& part : records(instance)) {
    if (part.keyword == keyword) return true;
  }
  return false;
}

std::string Part21File::string_of(const Part21Value& value) const {
  ISOCHOR_REQUIRE(value.is(Part21Kind::kString));
  const std::string_view raw = text({value.span.begin + 1, value.span.end - 1});
  std::string out;
  for (size_t k = 0; k < raw.size();) {
    const size_t used = raw[k] == '\\' ? directive(raw.substr(k), out) : 0;
    if (used > 0) {
      k += used;
      continue;
    }
    out.push_back(raw[k]);
    k += raw[k] == '\'' ? 2 : 1;
  }
  return out;
}

}  // namespace isochor::internal
