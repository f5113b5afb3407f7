// One reading of both clocks: turns monotonic engine instants into UTC where a value leaves the
// process, and back for what arrives. A plain value; pure; any thread.
#pragma once

#include "core/base/time.hpp"

namespace fieldcast {

struct UtcMapping {
  Instant instant{};  // of the engine's clock
  UtcTime utc{};      // of the wall clock, at the same moment

  // 0 ("no such time") for kLongAgo and kNever. Saturates instead of wrapping.
  [[nodiscard]] UtcTime to_utc(Instant at) const;
  [[nodiscard]] Instant to_instant(UtcTime at) const;  // the other way

  // Below this a newer reading of the clocks tells nothing: a reading takes time itself.
  static constexpr Duration kSame = std::chrono::microseconds{100};
  // This one as long as `newer` says the same: one instant is then always told as the same time.
  [[nodiscard]] UtcMapping followed_by(const UtcMapping& newer) const;
};

}  // namespace fieldcast
