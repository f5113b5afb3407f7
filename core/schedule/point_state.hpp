// What the scheduler remembers of a point. Instants are nanoseconds of the engine's clock; kNeverNs
// is later than all.
#pragma once

#include <cstdint>
#include <limits>

#include "core/model/spec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

inline constexpr std::int64_t kNeverNs = std::numeric_limits<std::int64_t>::max();

struct PointState {
  std::uint32_t first = 0, end = 1;  // its items
  AreaIndex area = 0;
  Mode mode = Mode::kScheduled;
  std::int8_t priority = 0;
  float elasticity = 1;
  bool readable = true;      // some request can carry it
  bool eager = true;         // to be read as soon as the wire would rest: never read yet, or failed
  bool bad = false;          // refused by the device, alone
  bool again = false;        // in imagination: read once already
  bool suspect = false;      // part of a refused block that is being bisected
  std::int64_t refresh = 0;  // as wished, but not less than
  std::int64_t least_refresh = 1;    // its own wire time
  double stretch = 1;                // factor on it under overload
  std::int64_t period = 1;           // largest gap allowed at present: stretched, less the lead
  std::int64_t due = kNeverNs;       // when it should be read again
  std::int64_t first_due = 0;        // one of its turns on the beat of its cluster,
  std::int64_t lap = 0;              // and from one turn to the next; 0: it has none
  std::int64_t deadline = kNeverNs;  // when its period runs out: never before it is due
  std::int64_t retry_at = 0;         // left alone until then
  std::int64_t cut_until =
      0;  // until then no block may hold this point together with the one before it

  [[nodiscard]] bool wanted() const { return readable && mode != Mode::kOnDemand; }
  [[nodiscard]] bool ready(std::int64_t now) const { return wanted() && retry_at <= now; }
  // Share of the period that is used up: 0 just read, 1 due.
  [[nodiscard]] double used(std::int64_t now) const {
    return 1.0 - static_cast<double>(due - now) / static_cast<double>(period);
  }
};

// `by` after `at`; never, if that is beyond all time.
[[nodiscard]] constexpr std::int64_t later(std::int64_t at, std::int64_t by) {
  return at >= kNeverNs - by ? kNeverNs : at + by;
}

// Whether a block may not hold both `left` and `right`, its neighbour in address order.
[[nodiscard]] inline bool cut_between(const PointState& left, const PointState& right,
                                      std::int64_t now) {
  return right.cut_until > now || left.bad || right.bad;
}

}  // namespace fieldcast
