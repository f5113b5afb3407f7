// A priority queue of small integers by time, whose entries can be moved and removed. Logarithmic;
// does not allocate after construction.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

class DueQueue {
 public:
  explicit DueQueue(std::size_t size) : node_of_(size, kOut), key_(size) { heap_.reserve(size); }

  [[nodiscard]] bool empty() const { return heap_.empty(); }
  [[nodiscard]] std::size_t size() const { return heap_.size(); }
  [[nodiscard]] std::uint32_t top() const { return heap_.front(); }
  [[nodiscard]] Instant top_key() const { return key_[heap_.front()]; }
  [[nodiscard]] bool holds(std::uint32_t id) const { return node_of_[id] != kOut; }
  // For partial walks: the children of node i are 2i+1 and 2i+2.
  [[nodiscard]] std::uint32_t at(std::size_t node) const { return heap_[node]; }
  [[nodiscard]] Instant key(std::uint32_t id) const { return key_[id]; }

  void put(std::uint32_t id, Instant key) {
    key_[id] = key;
    if (node_of_[id] == kOut) {
      node_of_[id] = static_cast<std::uint32_t>(heap_.size());
      heap_.push_back(id);
    }
    down(up(node_of_[id]));
  }

  void remove(std::uint32_t id) {
    const std::uint32_t node = node_of_[id];
    if (node == kOut) return;
    const std::uint32_t last = heap_.back();
    heap_.pop_back();
    node_of_[id] = kOut;
    if (last == id) return;
    heap_[node] = last;
    node_of_[last] = node;
    down(up(node));
  }

 private:
  static constexpr std::uint32_t kOut = ~0u;

  void swap_nodes(std::uint32_t a, std::uint32_t b) {
    std::swap(heap_[a], heap_[b]);
    node_of_[heap_[a]] = a;
    node_of_[heap_[b]] = b;
  }
  std::uint32_t up(std::uint32_t node) {
    while (node > 0 && key_[heap_[node]] < key_[heap_[(node - 1) / 2]]) {
      swap_nodes(node, (node - 1) / 2);
      node = (node - 1) / 2;
    }
    return node;
  }
  void down(std::uint32_t node) {
    for (;;) {
      std::uint32_t least = node;
      for (std::uint32_t child = 2 * node + 1; child <= 2 * node + 2 && child < heap_.size();
           ++child) {
        if (key_[heap_[child]] < key_[heap_[least]]) least = child;
      }
      if (least == node) return;
      swap_nodes(node, least);
      node = least;
    }
  }

  std::vector<std::uint32_t> heap_;     // ids
  std::vector<std::uint32_t> node_of_;  // by id
  std::vector<Instant> key_;            // by id
};

}  // namespace fieldcast
