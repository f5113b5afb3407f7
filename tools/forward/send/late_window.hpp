// How many bytes of late samples may be in flight, so that they use a free line and do not delay
// present values on a full one. Pure; one owner.
//
// The window grows with each acknowledgement while acknowledgements need at most kTarget longer
// than the fastest one did. Otherwise messages wait in a buffer on the way, and the window is
// halved once in this time (the idea of LEDBAT, RFC 6817).
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/base/time.hpp"

namespace fieldcast::forward {

class LateWindow {
 public:
  static constexpr std::size_t kLeast = 16u << 10, kMost = 8u << 20;  // bytes
  static constexpr Duration kTarget = std::chrono::milliseconds{250};

  // True if a message of `bytes` may be sent: one may always be in flight.
  [[nodiscard]] bool allows(std::size_t bytes) const {
    return in_flight_ == 0 || in_flight_ + bytes <= window_;
  }
  [[nodiscard]] std::size_t window() const { return window_; }

  void sent(std::size_t bytes) { in_flight_ += bytes; }
  void acknowledged(std::size_t bytes, Duration delay, Instant now) {
    failed(bytes);
    fastest_ = std::min(fastest_, delay);
    if (delay <= fastest_ + kTarget) {
      window_ = std::min(kMost, window_ + bytes);
    } else if (now - reduced_ > delay) {
      window_ = std::max(kLeast, window_ / 2);
      reduced_ = now;
    }
  }
  void failed(std::size_t bytes) { in_flight_ -= std::min(bytes, in_flight_); }

 private:
  std::size_t window_ = kLeast, in_flight_ = 0;
  Duration fastest_ = Duration::max() - kTarget;
  Instant reduced_{};
};

}  // namespace fieldcast::forward
