// Until when this bridge may put requests on the wire and samples into DDS: asked before each of
// them. A process that was stopped and goes on finds its lease over, and is silent until it has
// learned whether another bridge is master now. Any thread.
#pragma once

#include <atomic>

#include "bridge/bus/clock.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class MasterLease {
 public:
  // kNever: a bridge that stands alone. kLongAgo: not at all.
  void set(Instant until) { until_.store(until, std::memory_order_release); }
  [[nodiscard]] bool holds() const { return holds(steady_now()); }
  [[nodiscard]] bool holds(Instant now) const {
    return now < until_.load(std::memory_order_acquire);
  }

 private:
  std::atomic<Instant> until_{kNever};
};

}  // namespace fieldcast
