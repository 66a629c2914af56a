// The text of a STEP file (ISO 10303-21) as a table of its entity instances. Internal to `step`; no
// OpenCASCADE.
//
// The bytes of the file are kept, and everything found in them knows where it stands, so that a
// writer can change a few bytes and leave the others alone. One scan finds the instances; the
// arguments of one are parsed when they are asked for.
//
// Laws:
//  (1) the spans of instances do not overlap and rise with their index;
//  (2) what the grammar does not allow is refused with the number of the line, never guessed;
//  (3) time is O(n log n) and memory O(n) in the bytes, the stack does not grow with the input.
// Refused on purpose: `&SCOPE` (withdrawn from the standard), two instances of one number, files
// that end before END-ISO-10303-21. Bytes before ISO-10303-21 and after the end are allowed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace isochor::internal {

// Bytes [begin, end) of the file.
struct TextSpan {
  size_t begin = 0, end = 0;
  bool empty() const { return begin == end; }
  friend bool operator==(const TextSpan& a, const TextSpan& b) {
    return a.begin == b.begin && a.end == b.end;
  }
};

enum class Part21Kind {
  kReference,    // #12
  kString,       // 'text'
  kBinary,       // "0F3"
  kInteger,      // 12
  kReal,         // 1.5E-3
  kEnumeration,  // .TRUE.
  kList,         // (1,2)
  kTyped,        // LENGTH_MEASURE(1.)
  kOmitted,      // $
  kDerived,      // *
};

struct Part21Value {
  Part21Kind kind = Part21Kind::kOmitted;
  TextSpan span;  // without blanks or comments around it
  std::uint64_t reference = 0;
  double number = 0.0;             // of integers too
  std::string_view word;           // TRUE of .TRUE., LENGTH_MEASURE of a typed value
  std::vector<Part21Value> items;  // of a list or of a typed value

  bool is(Part21Kind other) const { return kind == other; }
  bool numeric() const { return kind == Part21Kind::kInteger || kind == Part21Kind::kReal; }
};

// KEYWORD(arguments): an instance, or one part of a complex instance.
struct Part21Record {
  std::string_view keyword;
  TextSpan span;
  std::vector<Part21Value> arguments;
};

struct Part21Instance {
  std::uint64_t number = 0;
  TextSpan span;             // from '#' to behind ';'
  TextSpan body;             // behind '=' to before ';'
  std::string_view keyword;  // empty: a complex instance, (PART(...) PART(...))
  size_t line = 0;           // of '#', from 1
  size_t section = 0;        // index into sections()
  bool complex() const { return keyword.empty(); }
};

struct Part21Section {
  TextSpan span;      // from DATA to before ENDSEC
  size_t endsec = 0;  // where ENDSEC stands
};

class Part21File {
 public:
  // Throws InputError(path, "line 12", reason) when the text breaks the grammar.
  Part21File(std::string path, std::string text);
  Part21File(const Part21File&) = delete;
  Part21File& operator=(const Part21File&) = delete;

  const std::string& path() const { return path_; }
  const std::string& text() const { return text_; }
  std::string_view text(const TextSpan& span) const {
    return std::string_view(text_).substr(span.begin, span.end - span.begin);
  }
  const TextSpan& header() const { return header_; }  // from HEADER to before its ENDSEC
  const std::vector<Part21Section>& sections() const { return sections_; }     // of data
  const std::vector<Part21Instance>& instances() const { return instances_; }  // in file order
  std::uint64_t largest_number() const;
  // "\r\n", "\n" or "\r", as the first line ends.
  const std::string& line_ending() const { return line_ending_; }

  // Null when there is none. O(log n).
  const Part21Instance* find(std::uint64_t number) const;
  // The instance that `value` (a reference) of `from` names. Throws InputError when there is none.
  const Part21Instance& follow(const Part21Instance& from, const Part21Value& value) const;

  // One record, or the parts of a complex instance. Throws InputError.
  std::vector<Part21Record> records(const Part21Instance& instance) const;
  // The one of that keyword, simple or part of a complex instance. Throws when there is none.
  Part21Record record(const Part21Instance& instance, std::string_view keyword) const;
  // Whether it is of that type, or has a part of it. Throws as `records` does when it is complex.
  bool is_a(const Part21Instance& instance, std::string_view keyword) const;

  // A string value as UTF-8, control directives (\X2\ and so on) decoded.
  std::string string_of(const Part21Value& value) const;

  // The line of a byte, from 1. O(n).
  size_t line_of(size_t offset) const;
  [[noreturn]] void refuse(size_t offset, const std::string& reason) const;

 private:
  friend class Part21Scanner;
  std::string path_, text_, line_ending_ = "\n";
  TextSpan header_;
  std::vector<Part21Section> sections_;
  std::vector<Part21Instance> instances_;
  std::vector<std::uint32_t> by_number_;  // indices into instances_, by rising number
};

// All bytes of a file. Throws InputError when it cannot be opened.
std::string file_bytes(const std::string& path);

// Throws InputError when the file cannot be read.
Part21File load_part21(const std::string& path);

}  // namespace isochor::internal
