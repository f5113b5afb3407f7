// Which commands were seen in the last seconds. In a standby group the router keeps those that were
// answered without it, the group the writes that another bridge has begun: such a command may still
// be on its way here, and it gets no second result, or run. The bridge keeps those that have their
// result: another member may hold one, and not have heard that.
//
// Pure; one owner, who guards it. Nothing can fail; when it is full, the oldest is forgotten.
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
  // As long as DDS may take to deliver a command: a reader that is away for longer is given up.
  static constexpr Duration kFor = std::chrono::seconds{10};
  static constexpr std::size_t kMost = 4096;
  using Key = std::pair<std::string, std::uint64_t>;  // requester, request_id

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
  std::deque<std::pair<Key, Instant>> order_;  // oldest first
};

}  // namespace fieldcast
