// Set of the commands of the last seconds, used in a standby group:
// - The router stores commands that another bridge has responded to, and the group stores writes
//   that another bridge has begun. Such a command may still be in flight to this bridge; it must
//   not run or get a second result.
// - The bridge stores commands that have their result: another member may hold such a command
//   without knowledge of the result.
//
// Pure; the owner guards it. If the set is full, the oldest entry is removed.
#pragma once

#include <cstdint>
#include <deque>
#include <set>
#include <string>
#include <utility>

#include "core/base/time.hpp"

namespace fieldcast {

class RecentCommands {
 public:
  // Longest time that DDS needs to deliver a command; a reader that is away longer is dropped.
  static constexpr Duration kFor = std::chrono::seconds{10};
  static constexpr std::size_t kMost = 4096;
  using Key = std::pair<std::string, std::uint64_t>;

  RecentCommands() = default;
  explicit RecentCommands(Duration kept) : kept_(kept) {}

  void note(const Key& key, Instant now) {
    forget(now);
    if (!keys_.insert(key).second) return;
    order_.emplace_back(key, now);
  }
  void remove(const Key& key) {
    if (keys_.erase(key) > 0) std::erase_if(order_, [&](const auto& e) { return e.first == key; });
  }
  [[nodiscard]] bool lately(const Key& key, Instant now) {
    forget(now);
    return keys_.contains(key);
  }

 private:
  void forget(Instant now) {
    while (!order_.empty() && (order_.front().second + kept_ <= now || order_.size() >= kMost)) {
      keys_.erase(order_.front().first);
      order_.pop_front();
    }
  }

  Duration kept_ = kFor;
  std::set<Key> keys_;
  std::deque<std::pair<Key, Instant>> order_;
};

}  // namespace fieldcast
