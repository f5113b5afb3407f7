// What is learned of a device's answer time: mean and spread as TCP learns its round trips (RFC 6298), and the timeout that
// follows.
#pragma once

#include "core/base/time.hpp"

namespace fieldcast {

class AnswerTime {
 public:
  // `configured` is the longest timeout ever used. `allowance` covers what the operating system and adapters add (chunked
  // delivery).
  AnswerTime(Duration configured, Duration allowance) : configured_(configured), allowance_(allowance) {}

  void learn(Duration measured);  // from the end of the request to the (computed) start of the answer; below zero counts as zero
  void timed_out();               // doubles the timeout until the next answer
  void forget();                  // another device may be there now

  [[nodiscard]] Duration timeout() const;                // never above the configured one
  [[nodiscard]] Duration mean() const { return mean_; }  // zero before the first answer
  [[nodiscard]] Duration spread() const { return spread_; }
  [[nodiscard]] bool known() const { return known_; }

 private:
  Duration configured_;
  Duration allowance_;
  Duration mean_{};
  Duration spread_{};
  bool known_ = false;
  unsigned doublings_ = 0;
};

}  // namespace fieldcast
