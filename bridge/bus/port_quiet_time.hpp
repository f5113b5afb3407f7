// Quiet time of each port after a bus has closed it: a device may still respond to the last
// request. A bus that opens the port waits for this time, so that no late response is matched to a
// new request.
//
// Any thread. Cannot fail.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast {

class PortQuietTime {
 public:
  // A bus closed `port` at `now`; responses may arrive until `until`. kLongAgo: none is pending.
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
