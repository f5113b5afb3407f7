// Buses of this process that stopped while a device could still answer: until when, by port. What
// is opened there next waits for that, so that nobody takes an answer to another one's request.
//
// Any thread. Nothing can fail.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast {

class AnswersUnderWay {
 public:
  // A bus let go of `port` at `now`; answers may come `until` then. kLongAgo: none will.
  void left(const std::string& port, Instant until, Instant now) {
    const std::lock_guard lock(mutex_);
    std::erase_if(until_, [now](const auto& row) { return row.second < now; });
    if (until != kLongAgo) until_[port] = until;
  }
  [[nodiscard]] Instant until(const std::string& port) const {
    const std::lock_guard lock(mutex_);
    const auto found = until_.find(port);
    return found == until_.end() ? kLongAgo : found->second;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Instant> until_;
};

}  // namespace fieldcast
