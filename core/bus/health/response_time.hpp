// Estimates a device's response time as TCP estimates round trips (RFC 6298), and the timeout from
// it. Plain value, owned by DeviceMonitor, on the bus's thread.
#pragma once

#include <algorithm>

#include "core/base/time.hpp"

namespace fieldcast {

class ResponseTime {
 public:
  // `configured`: longest timeout. `allowance`: delays of the operating system and of adapters.
  ResponseTime(Duration configured, Duration allowance)
      : configured_(configured), allowance_(allowance) {}

  // `measured`: end of the request to the computed start of the response; below zero counts as
  // zero.
  void learn(Duration measured);
  // Adds a response that arrived after its timeout.
  void late(Duration measured);
  // Doubles the timeout until the next response.
  void timed_out();
  void forget();

  // At most the configured timeout, at least the longest recent response time.
  [[nodiscard]] Duration timeout() const;
  // Longest of at least the last kWindow responses, late responses included.
  [[nodiscard]] Duration longest() const { return std::max(longest_, longest_before_); }
  // Returns true if the response began earlier than any response of this device so far: it belongs
  // to another request. Never true on a line that does not keep its baud rate. The earliest
  // measurement is ignored, because it may be wrong itself.
  [[nodiscard]] bool too_early(Duration measured, Duration character) const {
    return in_window_ + windows_ * kWindow >= kWindow / 16 &&
           std::min(second_, second_before_) > -character && measured < -2 * character;
  }
  [[nodiscard]] Duration mean() const { return mean_; }  // zero before the first response
  [[nodiscard]] Duration spread() const { return spread_; }
  [[nodiscard]] bool known() const { return known_; }

 private:
  static constexpr unsigned kWindow = 256;  // responses per window; extremes cover two windows
  void measure(Duration measured);

  Duration configured_;
  Duration allowance_;
  Duration mean_{};
  Duration spread_{};
  bool known_ = false;
  unsigned doublings_ = 0;
  unsigned in_window_ = 0, windows_ = 0;
  Duration longest_{}, longest_before_{};
  Duration soonest_ = Duration::max();
  Duration second_ = Duration::max(), second_before_ = Duration::max();  // second earliest response
};

}  // namespace fieldcast
