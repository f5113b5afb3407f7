// What is learned of a device's answer time: mean and spread as TCP learns its round trips (RFC
// 6298), and the timeout that follows. Plain value, owned by the DeviceMonitor, on the bus's
// thread. Nothing can fail.
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

  // From the end of the request to the (computed) start of the answer; below zero counts as zero.
  void learn(Duration measured);
  // The same of an answer that came after it had been given up.
  void late(Duration measured);
  // Doubles the timeout until the next answer.
  void timed_out();
  // Another device may be there now.
  void forget();

  // Never above the configured one, nor below the longest of the last answers.
  [[nodiscard]] Duration timeout() const;
  // Of the last kWindow answers at least, late ones included.
  [[nodiscard]] Duration longest() const { return std::max(longest_, longest_before_); }
  // The answer began too long before its request had ended: no answer of this device ever did so.
  // It is another device's answer, or a second one. Never true on a line that does not keep to its
  // baud rate. One answer that was not its own does not count: nobody knows the first ones.
  [[nodiscard]] bool too_early(Duration measured, Duration character) const {
    return in_window_ + windows_ * kWindow >= kWindow / 16 &&
           std::min(second_, second_before_) > -character && measured < -2 * character;
  }
  [[nodiscard]] Duration mean() const { return mean_; }  // zero before the first answer
  [[nodiscard]] Duration spread() const { return spread_; }
  [[nodiscard]] bool known() const { return known_; }

 private:
  static constexpr unsigned kWindow = 256;  // answers; extremes are those of two windows
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
  Duration second_ = Duration::max(), second_before_ = Duration::max();  // behind the soonest
};

}  // namespace fieldcast
