#include "isochor/step/part21.h"

#include <algorithm>
#include <fstream>
#include <limits>

#include "isochor/base/error.h"
#include "isochor/step/part21_text.h"

namespace isochor::internal {
namespace {

constexpr std::string_view kMagic = "ISO-10303-21";
constexpr std::string_view kEnd = "END-ISO-10303-21";

std::string ending_of(const std::string& text) {
  const size_t at = text.find_first_of("\r\n");
  if (at == std::string::npos || text[at] == '\n') return "\n";
  return at + 1 < text.size() && text[at + 1] == '\n' ? "\r\n" : "\r";
}

}  // namespace

// One pass over the text. Instances are only delimited: parentheses counted, strings and comments
// skipped.
class Part21Scanner {
 public:
  explicit Part21Scanner(Part21File& file) : file_(file), cursor_{file.text_} {
    cursor_.end = file.text_.size();
    line_break_ = file.line_ending_.back();
  }

  void run() {
    cursor_.at = file_.text_.find(kMagic);
    if (cursor_.at == std::string::npos) {
      throw InputError(file_.path_, "line 1", "is not a STEP file: 'ISO-10303-21' is missing");
    }
    cursor_.at += kMagic.size();
    expect(';', "'ISO-10303-21' is not followed by ';'");
    bool first = true;
    for (;;) {
      blanks();
      const size_t start = cursor_.at;
      if (file_.text_.compare(start, kEnd.size(), kEnd) == 0) break;
      const std::string_view word = cursor_.word();
      if (word.empty()) {
        file_.refuse(start, cursor_.done() ? "the file ends before END-ISO-10303-21"
                                           : "a section must start here");
      }
      if (first && word != "HEADER") file_.refuse(start, "the HEADER section is missing");
      section(word, start);
      first = false;
    }
    if (file_.sections_.empty()) file_.refuse(cursor_.at, "the file has no DATA section");
    sort_numbers();
  }

 private:
  void blanks() {
    cursor_.skip_blanks();
    check();
  }
  void check() const {
    if (cursor_.defect != nullptr) file_.refuse(cursor_.at, cursor_.defect);
  }
  void expect(char c, const char* reason) {
    blanks();
    if (!cursor_.take(c)) file_.refuse(cursor_.at, reason);
  }

  void section(std::string_view word, size_t start) {
    const bool data = word == "DATA";
    blanks();
    if (data && cursor_.peek() == '(') parameters();
    expect(';', "the name of a section is not followed by ';'");
    const size_t begin = start;
    size_t endsec = 0;
    for (;;) {
      blanks();
      endsec = cursor_.at;
      if (cursor_.done()) file_.refuse(start, "ENDSEC is missing: this section does not end");
      if (data && cursor_.peek() == '#') {
        instance();
        continue;
      }
      const std::string_view name = cursor_.word();
      if (name == "ENDSEC") break;
      if (data) file_.refuse(endsec, "neither an instance (#12=...) nor ENDSEC");
      rest_of_statement(endsec);
    }
    expect(';', "ENDSEC is not followed by ';'");
    if (data) file_.sections_.push_back({{begin, endsec}, endsec});
    if (word == "HEADER") file_.header_ = {begin, endsec};
  }

  // Behind the closing parenthesis of the opening one at the cursor.
  void parameters() {
    const size_t start = cursor_.at;
    size_t depth = 0;
    const std::string_view text = cursor_.text;
    for (size_t& at = cursor_.at; at < cursor_.end;) {
      switch (text[at]) {
        case '(':
          ++depth;
          ++at;
          break;
        case ')':
          ++at;
          if (--depth == 0) return;
          break;
        case '\'':
        case '"':
          cursor_.skip_quoted();
          check();
          break;
        case '/':
          if (at + 1 < cursor_.end && text[at + 1] == '*') {
            blanks();
          } else {
            ++at;
          }
          break;
        case ';':
          file_.refuse(at, "';' inside a list: a parenthesis is not closed");
        default:
          ++at;
      }
    }
    file_.refuse(start, "a parenthesis is not closed");
  }

  // A statement of the header or of a section that is not looked into.
  void rest_of_statement(size_t start) {
    while (!cursor_.done()) {
      blanks();
      const char c = cursor_.peek();
      if (c == ';') {
        ++cursor_.at;
        return;
      }
      if (c == '(') {
        parameters();
      } else if (c == '\'' || c == '"') {
        cursor_.skip_quoted();
        check();
      } else {
        ++cursor_.at;
      }
    }
    file_.refuse(start, "a statement does not end with ';'");
  }

  void instance() {
    Part21Instance found;
    found.span.begin = cursor_.at;
    found.line = line_at(cursor_.at);
    found.section = file_.sections_.size();
    ++cursor_.at;
    found.number = cursor_.instance_number();
    check();
    expect('=', "an instance number is not followed by '='");
    blanks();
    found.body.begin = cursor_.at;
    if (cursor_.peek() == '&') file_.refuse(cursor_.at, "'&SCOPE' is not supported");
    found.keyword = cursor_.word();
    if (!found.keyword.empty()) blanks();
    if (cursor_.peek() != '(') file_.refuse(cursor_.at, "'(' is missing");
    parameters();
    found.body.end = cursor_.at;
    expect(';', "an instance does not end with ';'");
    found.span.end = cursor_.at;
    file_.instances_.push_back(found);
  }

  size_t line_at(size_t offset) {
    const char* text = file_.text_.data();
    line_ += static_cast<size_t>(std::count(text + counted_, text + offset, line_break_));
    counted_ = offset;
    return line_;
  }

  void sort_numbers() {
    auto& order = file_.by_number_;
    const auto& all = file_.instances_;
    if (all.size() > std::numeric_limits<std::uint32_t>::max()) {
      file_.refuse(0, "has too many instances");
    }
    order.resize(all.size());
    for (size_t k = 0; k < order.size(); ++k) order[k] = static_cast<std::uint32_t>(k);
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      return all[a].number != all[b].number ? all[a].number < all[b].number : a < b;
    };
    if (!std::is_sorted(order.begin(), order.end(), before)) {
      std::sort(order.begin(), order.end(), before);
    }
    for (size_t k = 1; k < order.size(); ++k) {
      if (all[order[k]].number != all[order[k - 1]].number) continue;
      file_.refuse(all[order[k]].span.begin,
                   "#" + std::to_string(all[order[k]].number) + " stands in line " +
                       std::to_string(all[order[k - 1]].line) + " already");
    }
  }

  Part21File& file_;
  TextCursor cursor_;
  char line_break_ = '\n';
  size_t line_ = 1, counted_ = 0;
};

Part21File::Part21File(std::string path, std::string text)
    : path_(std::move(path)), text_(std::move(text)), line_ending_(ending_of(text_)) {
  Part21Scanner(*this).run();
}

std::uint64_t Part21File::largest_number() const {
  return by_number_.empty() ? 0 : instances_[by_number_.back()].number;
}

const Part21Instance* Part21File::find(std::uint64_t number) const {
  // Most files number without gaps.
  if (!by_number_.empty() && number >= instances_[by_number_.front()].number) {
    const std::uint64_t place = number - instances_[by_number_.front()].number;
    if (place < by_number_.size() && instances_[by_number_[place]].number == number) {
      return &instances_[by_number_[place]];
    }
  }
  const auto found =
      std::lower_bound(by_number_.begin(), by_number_.end(), number,
                       [&](std::uint32_t k, std::uint64_t n) { return instances_[k].number < n; });
  if (found == by_number_.end() || instances_[*found].number != number) return nullptr;
  return &instances_[*found];
}

const Part21Instance& Part21File::follow(const Part21Instance& from,
                                         const Part21Value& value) const {
  const std::string name = "#" + std::to_string(from.number);
  if (!value.is(Part21Kind::kReference)) {
    refuse(value.span.begin, name + " has '" + std::string(text(value.span).substr(0, 40)) +
                                 "' where it should refer to an instance");
  }
  const Part21Instance* found = find(value.reference);
  if (found == nullptr) {
    refuse(value.span.begin,
           name + " refers to #" + std::to_string(value.reference) + ", which is not in the file");
  }
  return *found;
}

size_t Part21File::line_of(size_t offset) const {
  const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text_.size()));
  return 1 + static_cast<size_t>(std::count(text_.begin(), end, line_ending_.back()));
}

void Part21File::refuse(size_t offset, const std::string& reason) const {
  throw InputError(path_, "line " + std::to_string(line_of(offset)), reason);
}

std::string file_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) throw InputError(path, "", "cannot be opened for reading");
  std::string bytes(static_cast<size_t>(std::max<std::streamoff>(0, in.tellg())), '\0');
  in.seekg(0);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<size_t>(in.gcount()));
  return bytes;
}

Part21File load_part21(const std::string& path) { return Part21File(path, file_bytes(path)); }

}  // namespace isochor::internal
