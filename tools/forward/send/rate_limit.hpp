// Limits the bytes a second of an outlet. Pure; one owner.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/time.hpp"

namespace fieldcast::forward {

class RateLimit {
 public:
  // 0: no limit.
  explicit RateLimit(std::uint64_t bytes_per_second) : rate_(bytes_per_second) {}

  // Returns true if the next message may be sent. After a pause, the bytes of kBurst are allowed
  // without a wait.
  [[nodiscard]] bool allows(Instant now) const { return rate_ == 0 || next_ <= now; }
  [[nodiscard]] Instant next() const { return next_; }
  void sent(std::size_t bytes, Instant now) {
    if (rate_ == 0) return;
    next_ = std::max(next_, now - kBurst) +
            Duration{static_cast<std::int64_t>(1e9 * static_cast<double>(bytes) /
                                               static_cast<double>(rate_))};
  }

 private:
  static constexpr Duration kBurst = std::chrono::milliseconds{100};

  std::uint64_t rate_;
  Instant next_{};
};

}  // namespace fieldcast::forward
