#include "isochor/step/part21_references.h"

#include <algorithm>

namespace isochor::internal {
namespace {

// Depth is limited by the parser.
void collect(const std::vector<Part21Value>& values, std::uint32_t user,
             std::vector<Part21Use>& uses) {
  for (const auto& value : values) {
    if (value.is(Part21Kind::kReference)) uses.push_back({value.reference, user, value.span});
    collect(value.items, user, uses);
  }
}

bool by_target(const Part21Use& a, const Part21Use& b) { return a.target < b.target; }

}  // namespace

Part21References::Part21References(const Part21File& file) {
  const auto& all = file.instances();
  for (std::uint32_t k = 0; k < all.size(); ++k) {
    for (const auto& part : file.records(all[k])) collect(part.arguments, k, uses_);
  }
  std::stable_sort(uses_.begin(), uses_.end(), by_target);
}

Part21References::Range Part21References::to(std::uint64_t number) const {
  Part21Use wanted;
  wanted.target = number;
  const auto range = std::equal_range(uses_.begin(), uses_.end(), wanted, by_target);
  return {range.first, range.second};
}

}  // namespace isochor::internal
