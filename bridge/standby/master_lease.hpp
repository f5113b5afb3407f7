// Time until which this bridge may send and publish; checked before each request and sample. It
// expires while the process is stopped, until the bridge has received the master. Any thread.
#pragma once

#include <atomic>

#include "bridge/base/clock.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class MasterLease {
 public:
  // kNever: a bridge without a group. kLongAgo: the lease is not held.
  void set(Instant until) { until_.store(until, std::memory_order_release); }
  [[nodiscard]] bool holds() const { return holds(steady_now()); }
  [[nodiscard]] bool holds(Instant now) const {
    return now < until_.load(std::memory_order_acquire);
  }

 private:
  std::atomic<Instant> until_{kNever};
};

}  // namespace fieldcast
