// A map from parameters to small numbers, whose cost follows the number of entries.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace isochor::internal {

// A table over the keys' range where they are known and it is not much longer than their list, else
// open addressing with linear probing. Keys are not negative.
class IndexMap {
 public:
  static constexpr int kNone = -1;

  // Empty, with room for so many entries.
  explicit IndexMap(size_t entries) { make_slots(entries); }
  // Each key's place in the list; of a key that is there twice, the first.
  explicit IndexMap(const std::vector<int>& keys) {
    if (keys.empty()) return;
    const auto [low, high] = std::minmax_element(keys.begin(), keys.end());
    const size_t range = static_cast<size_t>(*high - *low) + 1;
    if (range <= kDirect * keys.size()) {
      low_ = *low;
      direct_.assign(range, kNone);
    } else {
      make_slots(keys.size());
    }
    for (size_t k = 0; k < keys.size(); ++k) {
      repetition_ = !insert(keys[k], static_cast<int>(k)) || repetition_;
    }
  }

  // False when the key is there already. Only keys of the list, or any with room left.
  bool insert(int key, int value) {
    int& place = slots_.empty() ? direct_[static_cast<size_t>(key - low_)] : slot(key);
    if (place != kNone) return false;
    place = value;
    return true;
  }
  // Whether the list had a key twice.
  bool has_repetition() const { return repetition_; }
  // kNone when the key is not there.
  int operator[](int key) const {
    if (slots_.empty()) {
      const auto place = static_cast<size_t>(key) - static_cast<size_t>(low_);
      return place < direct_.size() ? direct_[place] : kNone;
    }
    const Slot& slot = slots_[find(key)];
    return slot.key == key ? slot.value : kNone;
  }
  bool contains(int key) const { return (*this)[key] != kNone; }

 private:
  static constexpr size_t kDirect = 8;
  struct Slot {
    int key = kNone;
    int value = kNone;
  };

  void make_slots(size_t entries) {
    size_t size = 8;
    while (size < 2 * entries) size *= 2;
    slots_.resize(size);
  }
  int& slot(int key) {
    Slot& slot = slots_[find(key)];
    slot.key = key;
    return slot.value;
  }
  size_t find(int key) const {
    const size_t mask = slots_.size() - 1;
    size_t place = (static_cast<std::uint64_t>(key) * 0x9e3779b97f4a7c15u >> 20) & mask;
    while (slots_[place].key != kNone && slots_[place].key != key) place = (place + 1) & mask;
    return place;
  }

  int low_ = 0;
  bool repetition_ = false;
  std::vector<int> direct_;
  std::vector<Slot> slots_;
};

}  // namespace isochor::internal
