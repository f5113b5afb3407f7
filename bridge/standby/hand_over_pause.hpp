// Wait of a master that has handed over: its successor must have written everything before the
// buses of this one leave the domain. Pure: `now` is a parameter; one owner.
#pragma once

#include <algorithm>
#include <optional>

#include "core/base/time.hpp"

namespace fieldcast {

class HandOverPause {
 public:
  static constexpr Duration kLength = std::chrono::milliseconds{500};

  // The hand-over has ended. A second call does not extend the pause.
  void begin(Instant now) {
    if (!until_) until_ = now + kLength;
  }
  [[nodiscard]] bool has_begun() const { return until_.has_value(); }
  // Zero if the pause is over or has not begun.
  [[nodiscard]] Duration left(Instant now) const {
    return until_ ? std::max(*until_ - now, Duration::zero()) : Duration::zero();
  }

 private:
  std::optional<Instant> until_;
};

}  // namespace fieldcast
