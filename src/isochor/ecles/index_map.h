// A map from parameters to their places in a list, whose cost follows the length of the list.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace isochor::internal {

// A table over the keys' range where it is not much longer than the list, else open addressing with
// linear probing.
class IndexMap {
 public:
  static constexpr int kNone = -1;

  // Keys are not negative. Of a key that is there twice, one place is kept.
  explicit IndexMap(const std::vector<int>& keys) {
    if (keys.empty()) return;
    const auto [low, high] = std::minmax_element(keys.begin(), keys.end());
    const size_t range = static_cast<size_t>(*high - *low) + 1;
    if (range <= kDirect * keys.size()) {
      low_ = *low;
      direct_.assign(range, kNone);
    } else {
      size_t size = 8;
      while (size < 2 * keys.size()) size *= 2;
      slots_.resize(size);
    }
    for (size_t k = 0; k < keys.size(); ++k) insert(keys[k], static_cast<int>(k));
  }

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

  void insert(int key, int value) {
    int& place = slots_.empty() ? direct_[static_cast<size_t>(key - low_)] : slot(key);
    repetition_ = repetition_ || place != kNone;
    place = value;
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
