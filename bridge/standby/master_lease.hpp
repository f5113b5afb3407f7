// Time until which this bridge may send requests and publish samples; checked before each of them.
// After a stopped process continues, the lease has expired, and the bridge is silent until it has
// received which bridge is master. Any thread.
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
