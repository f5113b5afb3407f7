// A priority queue of small integers by instant, smallest first, in which every entry can be moved
// or taken out. Logarithmic; no allocation after construction.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace fieldcast {

class DueQueue {
 public:
  explicit DueQueue(std::size_t size) : slot_of_(size, kOut), key_(size, 0) { heap_.reserve(size); }

  [[nodiscard]] bool empty() const { return heap_.empty(); }
  [[nodiscard]] std::size_t size() const { return heap_.size(); }
  [[nodiscard]] std::uint32_t top() const { return heap_.front(); }
  [[nodiscard]] std::int64_t top_key() const { return key_[heap_.front()]; }
  [[nodiscard]] bool holds(std::uint32_t id) const { return slot_of_[id] != kOut; }
  // The heap itself, for walks that look at a few entries in order: children of slot i are 2i+1 and
  // 2i+2.
  [[nodiscard]] std::uint32_t at(std::size_t slot) const { return heap_[slot]; }
  [[nodiscard]] std::int64_t key(std::uint32_t id) const { return key_[id]; }

  void put(std::uint32_t id, std::int64_t key) {
    key_[id] = key;
    if (slot_of_[id] == kOut) {
      slot_of_[id] = static_cast<std::uint32_t>(heap_.size());
      heap_.push_back(id);
    }
    down(up(slot_of_[id]));
  }

  void remove(std::uint32_t id) {
    const std::uint32_t slot = slot_of_[id];
    if (slot == kOut) return;
    const std::uint32_t last = heap_.back();
    heap_.pop_back();
    slot_of_[id] = kOut;
    if (last == id) return;
    heap_[slot] = last;
    slot_of_[last] = slot;
    down(up(slot));
  }

 private:
  static constexpr std::uint32_t kOut = ~0u;

  void swap_slots(std::uint32_t a, std::uint32_t b) {
    std::swap(heap_[a], heap_[b]);
    slot_of_[heap_[a]] = a;
    slot_of_[heap_[b]] = b;
  }
  std::uint32_t up(std::uint32_t slot) {
    while (slot > 0 && key_[heap_[slot]] < key_[heap_[(slot - 1) / 2]]) {
      swap_slots(slot, (slot - 1) / 2);
      slot = (slot - 1) / 2;
    }
    return slot;
  }
  void down(std::uint32_t slot) {
    for (;;) {
      std::uint32_t least = slot;
      for (std::uint32_t child = 2 * slot + 1; child <= 2 * slot + 2 && child < heap_.size();
           ++child) {
        if (key_[heap_[child]] < key_[heap_[least]]) least = child;
      }
      if (least == slot) return;
      swap_slots(slot, least);
      slot = least;
    }
  }

  std::vector<std::uint32_t> heap_;
  std::vector<std::uint32_t> slot_of_;
  std::vector<std::int64_t> key_;
};

}  // namespace fieldcast
