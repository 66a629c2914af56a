#include "isochor/step/step_records.h"

#include <limits>
#include <string_view>
#include <utility>

#include "isochor/step/part21_text.h"

namespace isochor::internal {
namespace {

// Schemas nest lists three deep.
constexpr size_t kDeepest = 64;

// What OpenCASCADE's scanner understands inside a string: no control characters before the
// tabulator, neither delete nor 0x80.
bool is_plain(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= 0x09 && byte != 0x7F && byte != 0x80;
}

bool is_hexadecimal(char c) { return is_digit(c) || (c >= 'A' && c <= 'F'); }

class Scanner {
 public:
  Scanner(const std::string& text, size_t start) : cursor_{text, start, text.size()} {}

  bool run() {
    if (cursor_.text.size() > std::numeric_limits<std::uint32_t>::max()) return false;
    if (!literal("ISO-10303-21;") || !blanks() || !literal("HEADER;")) return false;
    while (blanks() && !literal("ENDSEC;")) {
      if (!record({}) || !semicolon()) return false;
    }
    result_.header = static_cast<std::uint32_t>(result_.records.size());
    if (result_.header == 0 || !blanks() || !literal("DATA;")) return false;
    while (blanks() && !literal("ENDSEC;")) {
      if (!entity()) return false;
    }
    if (result_.records.size() == result_.header) return false;
    if (!blanks() || !literal("END-ISO-10303-21;")) return false;
    return blanks() && cursor_.done();
  }

  StepRecords take() { return std::move(result_); }

 private:
  // A record whose list is being read, or a list inside it.
  struct Open {
    StepRecord record;
    size_t pending = 0;  // where its arguments begin among those that wait
  };

  bool literal(std::string_view expected) {
    if (cursor_.text.compare(cursor_.at, expected.size(), expected) != 0) return false;
    cursor_.at += expected.size();
    return true;
  }

  // False at a comment that OpenCASCADE could misread.
  bool blanks() {
    for (;;) {
      const char c = cursor_.peek();
      if (c == ' ' || c == '\n' || c == '\r' || c == '\t') {
        ++cursor_.at;
      } else if (c == '/') {
        const size_t begin = cursor_.at;
        cursor_.skip_blanks();
        if (cursor_.defect != nullptr || cursor_.at == begin) return false;
        const auto passed = cursor_.text.substr(begin, cursor_.at - begin);
        const auto has = [&](const char* word) { return passed.find(word) != passed.npos; };
        if (passed.find_first_of("'\"\f\v") != passed.npos) return false;
        if (has(";") && (has("ISO") || has("STEP;"))) return false;
      } else {
        return true;
      }
    }
  }

  bool semicolon() { return blanks() && cursor_.take(';'); }

  TextSpan word() {
    const size_t begin = cursor_.at;
    const std::string_view found = cursor_.word();
    if (found == "ENDSCOPE") return {};
    return {begin, cursor_.at};
  }

  // "#12"; empty when there is none.
  TextSpan ident() {
    const size_t begin = cursor_.at;
    if (!cursor_.take('#')) return {};
    const size_t digits = cursor_.at;
    skip(is_digit);
    if (cursor_.at == digits || cursor_.at - digits > kMostDigits) return {};
    return {begin, cursor_.at};
  }

  template <typename Is>
  void skip(const Is& is) {
    while (!cursor_.done() && is(cursor_.text[cursor_.at])) ++cursor_.at;
  }

  bool entity() {
    const TextSpan name = ident();
    if (name.empty()) return false;
    skip([](char c) { return c == ' ' || c == '\t'; });
    if (!cursor_.take('=') || !blanks()) return false;
    if (!cursor_.take('(')) return record(name) && semicolon();
    TextSpan next = name;  // only the first part has it
    int parts = 0;
    for (; blanks() && !cursor_.take(')'); ++parts) {
      if (!record(next)) return false;
      next = {};
    }
    return parts > 0 && semicolon();
  }

  // KEYWORD(arguments)
  bool record(const TextSpan& name) {
    Open open;
    open.record.ident = name;
    open.record.type = word();
    lists_ = 0;
    if (open.record.type.empty() || !blanks() || !cursor_.take('(')) return false;
    open_.assign(1, open);
    pending_.clear();
    bool first = true;
    while (!open_.empty()) {
      if (!blanks()) return false;
      if (first && cursor_.take(')')) {  // an empty list
        close();
        first = false;
      } else if (first || cursor_.take(',')) {
        if (!blanks()) return false;
        const size_t depth = open_.size();
        if (!argument()) return false;
        first = open_.size() > depth;
      } else if (cursor_.take(')')) {
        close();
      } else {
        return false;
      }
    }
    return true;
  }

  // Of the list that ends here; it is an argument of the one around it.
  void close() {
    Open& last = open_.back();
    last.record.first = static_cast<std::uint32_t>(result_.arguments.size());
    last.record.count = static_cast<std::uint32_t>(pending_.size() - last.pending);
    const auto from = pending_.begin() + static_cast<std::ptrdiff_t>(last.pending);
    result_.arguments.insert(result_.arguments.end(), from, pending_.end());
    pending_.erase(from, pending_.end());
    result_.records.push_back(last.record);
    const std::uint32_t list = last.record.list;
    open_.pop_back();
    if (!open_.empty()) pending_.push_back({Part21Kind::kList, {}, list});
  }

  bool open(const TextSpan& type) {
    if (!cursor_.take('(') || open_.size() >= kDeepest) return false;
    Open inner;
    inner.record.type = type;
    inner.record.list = ++lists_;
    inner.pending = pending_.size();
    open_.push_back(inner);
    if (lists_ > result_.lists) result_.lists = lists_;
    return true;
  }

  bool argument() {
    const size_t begin = cursor_.at;
    const auto add = [&](Part21Kind kind) {
      pending_.push_back({kind, {begin, cursor_.at}, 0});
      return true;
    };
    const char c = cursor_.peek();
    switch (c) {
      case '#':
        return !ident().empty() && add(Part21Kind::kReference);
      case '\'':
        return quoted() && add(Part21Kind::kString);
      case '"':
        return binary() && add(Part21Kind::kBinary);
      case '.':
        return enumeration() && add(Part21Kind::kEnumeration);
      case '(':
        return open({});
      case '$':
      case '*':
        ++cursor_.at;
        return add(c == '$' ? Part21Kind::kOmitted : Part21Kind::kDerived);
      default:
        break;
    }
    if (is_digit(c) || c == '-' || c == '+') {
      const bool real = number();
      return cursor_.defect == nullptr && add(real ? Part21Kind::kReal : Part21Kind::kInteger);
    }
    const TextSpan type = word();
    return !type.empty() && blanks() && open(type);
  }

  bool quoted() {
    const size_t begin = cursor_.at;
    cursor_.skip_quoted();
    if (cursor_.defect != nullptr) return false;
    for (size_t k = begin; k < cursor_.at; ++k) {
      if (!is_plain(cursor_.text[k])) return false;
    }
    return true;
  }

  bool binary() {
    cursor_.take('"');
    const size_t begin = cursor_.at;
    skip(is_hexadecimal);
    return cursor_.at > begin && cursor_.take('"');
  }

  bool enumeration() {
    cursor_.take('.');
    const char first = cursor_.peek();
    if (is_digit(first)) return false;
    const size_t begin = cursor_.at;
    skip([](char c) { return is_digit(c) || c == '_' || (c >= 'A' && c <= 'Z'); });
    return cursor_.at > begin && cursor_.take('.');
  }

  // Whether it has a point, which one with an exponent must have.
  bool number() {
    if (!cursor_.take('-')) cursor_.take('+');
    const size_t begin = cursor_.at;
    skip(is_digit);
    if (cursor_.at == begin) cursor_.defect = "no digits";
    if (!cursor_.take('.')) return false;
    skip(is_digit);
    if (!cursor_.take('E')) return true;
    if (!cursor_.take('-')) cursor_.take('+');
    const size_t exponent = cursor_.at;
    skip(is_digit);
    if (cursor_.at == exponent) cursor_.defect = "no digits";
    return true;
  }

  static constexpr size_t kMostDigits = 9;  // OpenCASCADE's numbers have 32 bits

  TextCursor cursor_;
  StepRecords result_;
  std::vector<Open> open_;
  std::vector<StepArgument> pending_;
  std::uint32_t lists_ = 0;  // opened inside the present record
};

}  // namespace

std::optional<StepRecords> scan_step(const std::string& text, size_t start) {
  Scanner scanner(text, start);
  if (!scanner.run()) return std::nullopt;
  return scanner.take();
}

}  // namespace isochor::internal
