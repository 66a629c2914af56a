// Who refers to whom in a STEP file. Internal to `step`; no OpenCASCADE.
#pragma once

#include <cstdint>
#include <vector>

#include "isochor/step/part21.h"

namespace isochor::internal {

// One reference: `value` of an instance.
struct Part21Use {
  std::uint64_t target = 0;
  std::uint32_t user = 0;  // index into Part21File::instances()
  TextSpan span;
};

class Part21References {
 public:
  // Parses the whole file. Throws InputError at the first instance that breaks the grammar.
  explicit Part21References(const Part21File& file);

  // The references to an instance, in file order. O(log n).
  struct Range {
    std::vector<Part21Use>::const_iterator first, last;
    auto begin() const { return first; }
    auto end() const { return last; }
    size_t size() const { return static_cast<size_t>(last - first); }
  };
  Range to(std::uint64_t number) const;

 private:
  std::vector<Part21Use> uses_;  // by target, then by place
};

}  // namespace isochor::internal
