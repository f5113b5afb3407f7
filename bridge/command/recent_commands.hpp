// Which commands were seen in the last seconds. Two owners in a standby group keep one each: the
// router those that were answered without it, the group the writes that another bridge has begun.
// Such a command may still be on its way here: it has its result, or its run, and gets no second
// one.
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
    while (!order_.empty() && (order_.front().second + kFor <= now || order_.size() >= kMost)) {
      keys_.erase(order_.front().first);
      order_.pop_front();
    }
  }

  std::set<Key> keys_;
  std::deque<std::pair<Key, Instant>> order_;  // oldest first
};

}  // namespace fieldcast
