// What is learned of a device's answer time: mean and spread as TCP learns its round trips (RFC
// 6298), and the timeout that follows.
#pragma once

#include <algorithm>

#include "core/base/time.hpp"

namespace fieldcast {

class AnswerTime {
 public:
  // `configured` is the longest timeout ever used. `allowance` covers what the operating system and
  // adapters add (chunked delivery).
  AnswerTime(Duration configured, Duration allowance)
      : configured_(configured), allowance_(allowance) {}

  void learn(Duration measured);  // from the end of the request to the (computed) start of the
                                  // answer; below zero counts as zero
  void late(Duration measured);   // of an answer that came after it had been given up
  void timed_out();               // doubles the timeout until the next answer
  void forget();                  // another device may be there now

  // Never above the configured one, nor below the longest of the last answers.
  [[nodiscard]] Duration timeout() const;
  // Of the last kWindow answers at least, late ones included.
  [[nodiscard]] Duration longest() const { return std::max(longest_, longest_before_); }
  // Begun so long before its request had ended that no answer of this device ever has: it is
  // somebody else's, or one too many. Never true on a line that does not keep to its baud rate.
  [[nodiscard]] bool too_early(Duration measured, Duration character) const {
    return in_window_ + windows_ * kWindow >= kWindow / 16 &&
           std::min(soonest_, soonest_before_) > -character && measured < -2 * character;
  }
  [[nodiscard]] Duration mean() const { return mean_; }  // zero before the first answer
  [[nodiscard]] Duration spread() const { return spread_; }
  [[nodiscard]] bool known() const { return known_; }

 private:
  static constexpr unsigned kWindow = 256;  // answers; the extremes of this one and the last count
  void measure(Duration measured);

  Duration configured_;
  Duration allowance_;
  Duration mean_{};
  Duration spread_{};
  bool known_ = false;
  unsigned doublings_ = 0;
  unsigned in_window_ = 0, windows_ = 0;
  Duration longest_{}, longest_before_{};
  Duration soonest_ = Duration::max(), soonest_before_ = Duration::max();
};

}  // namespace fieldcast
