// A map from parameters to small numbers whose cost follows the number of entries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace isochor::internal {

// Open addressing with linear probing; keys are not negative.
class IndexMap {
 public:
  static constexpr int kNone = -1;

  // Room for so many entries.
  explicit IndexMap(size_t entries) {
    size_t size = 8;
    while (size < 2 * entries) size *= 2;
    slots_.resize(size);
  }

  // False when the key is there already.
  bool insert(int key, int value) {
    Slot& slot = slots_[find(key)];
    if (slot.key == key) return false;
    slot = {key, value};
    return true;
  }
  // kNone when the key is not there.
  int operator[](int key) const {
    const Slot& slot = slots_[find(key)];
    return slot.key == key ? slot.value : kNone;
  }

 private:
  struct Slot {
    int key = kNone;
    int value = kNone;
  };

  size_t find(int key) const {
    const size_t mask = slots_.size() - 1;
    size_t place = (static_cast<std::uint64_t>(key) * 0x9e3779b97f4a7c15u >> 20) & mask;
    while (slots_[place].key != kNone && slots_[place].key != key) place = (place + 1) & mask;
    return place;
  }

  std::vector<Slot> slots_;
};

}  // namespace isochor::internal
