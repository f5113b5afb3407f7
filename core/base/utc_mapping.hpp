// One reading of both clocks: converts monotonic engine instants to UTC when a value leaves the
// process, and back for received values. A plain value; pure; any thread.
#pragma once

#include "core/base/time.hpp"

namespace fieldcast {

struct UtcMapping {
  Instant instant{};  // of the engine's clock
  UtcTime utc{};      // of the wall clock, at the same moment

  // Returns 0 ("no such time") for kLongAgo and kNever. Saturates instead of wrapping.
  [[nodiscard]] UtcTime to_utc(Instant at) const;
  [[nodiscard]] Instant to_instant(UtcTime at) const;

  // Differences below this are ignored: a reading of the clocks itself lasts some time.
  static constexpr Duration kSame = std::chrono::microseconds{100};
  // Returns this mapping while `newer` agrees with it, so that one instant is always converted to
  // the same time.
  [[nodiscard]] UtcMapping followed_by(const UtcMapping& newer) const;
};

}  // namespace fieldcast
