// Wait before a port or a database is opened again: 0.1 s, doubling to 30 s. Pure; one owner.
#pragma once

#include <algorithm>

#include "core/base/time.hpp"

namespace fieldcast {

class BackOff {
 public:
  static constexpr Duration kFirst = std::chrono::milliseconds{100};
  static constexpr Duration kLongest = std::chrono::seconds{30};
  // A port that stays open this long has recovered; one that closes sooner has not.
  static constexpr Duration kProven = std::chrono::seconds{5};

  explicit BackOff(Duration longest = kLongest) : longest_(longest) {}

  // Call when there is a new reason to try.
  void reset() { next_ = kFirst; }
  void opened(Instant now) { opened_ = now; }
  // Returns the wait before the next attempt. Call when the port was closed or could not be opened.
  [[nodiscard]] Duration closed(Instant now) {
    if (opened_ != kLongAgo && now - opened_ >= kProven) next_ = kFirst;
    opened_ = kLongAgo;
    const Duration wait = next_;
    next_ = std::min(next_ * 2, longest_);
    return wait;
  }

 private:
  Duration longest_;
  Instant opened_ = kLongAgo;
  Duration next_ = kFirst;
};

}  // namespace fieldcast
