// Changes to the text of a STEP file that leave every other byte alone. Internal to `step`; no
// OpenCASCADE.
//
// Laws:
//  (1) without changes the text is the file's, byte for byte;
//  (2) outside the replaced spans, the removed and the appended lines the text is the file's;
//  (3) numbers are written with the fewest digits that read back as the same double.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "isochor/step/part21.h"

namespace isochor::internal {

// A REAL of ISO 10303-21: "1.", "-2.5E-7". `value` must be finite.
std::string step_real(double value);

class Part21Edit {
 public:
  // `file` must outlive the edit.
  explicit Part21Edit(const Part21File& file)
      : file_(file), next_(file.largest_number() + 1), appended_(file.sections().size()) {}

  // Puts `text` in the place of one argument of an instance. Spans must be the same or disjoint;
  // a later change of the same span replaces the earlier.
  void replace(const Part21Instance& instance, const TextSpan& span, std::string text);
  // The same with a reference; nothing happens when it is the one already.
  void repoint(const Part21Instance& instance, const Part21Value& reference, std::uint64_t to);
  // A new instance, a line at the end of the data section of `beside`; `body` without '#12=' and
  // ';'; line breaks between its values are left out.
  // Returns its number, one more than the largest so far.
  std::uint64_t append(const Part21Instance& beside, const std::string& body);

  // Takes out an instance that has no other changes, with its line when it stands there alone.
  void remove(const Part21Instance& instance);

  int lines_appended() const { return count_; }
  int lines_changed() const { return static_cast<int>(changed_.size()); }
  bool empty() const { return count_ == 0 && changed_.empty(); }

  std::string text() const;

 private:
  struct Replacement {
    size_t end = 0;
    std::string text;
  };
  const Part21File& file_;
  std::uint64_t next_;
  int count_ = 0;
  std::map<size_t, Replacement> replacements_;  // by where they begin
  std::set<std::uint64_t> changed_;             // instances
  std::vector<std::string> appended_;           // by section
};

}  // namespace isochor::internal
