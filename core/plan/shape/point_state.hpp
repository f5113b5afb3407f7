// What planning and dispatching know of a point. Plain values.
#pragma once

#include <cstdint>

#include "core/model/spec.hpp"
#include "core/plan/time_math.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

// The part that a plan follows from: what is asked for, and what the device refuses.
struct PlannedPoint {
  std::uint32_t first = 0, end = 1;  // items first .. end-1
  AreaIndex area = 0;
  Mode mode = Mode::kScheduled;
  std::int8_t priority = 0;
  float elasticity = 1;
  bool readable = true;       // some request can carry it
  bool bad = false;           // the device refuses it, even alone
  Duration refresh{};         // as asked for, but never less than `least_refresh`
  Duration least_refresh{1};  // the wire time of a read of this point alone
  double stretch = 1;         // factor on the refresh under overload
  Instant cut_until{};        // until then no read may hold this point and the one before it

  [[nodiscard]] bool wanted() const { return readable && mode != Mode::kOnDemand; }
};

// The part that changes with every read, of a real wire or of an imagined one.
struct PointState : PlannedPoint {
  bool eager = true;          // read it as soon as the wire would rest: never read yet, or failed
  bool again = false;         // only in an imagined run: it was read before
  bool suspect = false;       // part of a refused read whose halves are being tried
  Duration allowed_gap{1};    // largest gap at present: the stretched refresh less the lead
  Instant due = kNever;       // when it should be read again
  Instant deadline = kNever;  // when the allowed gap ends: never before it is due
  Instant retry_at{};         // left alone until then
  Instant phase{};            // one instant of its cycle: it is due then
  Duration period{};          // from one instant of its cycle to the next; zero: no cycle

  [[nodiscard]] bool ready(Instant now) const { return wanted() && retry_at <= now; }
  // Share of the allowed gap that is used up: 0 just read, 1 due.
  [[nodiscard]] double used(Instant now) const { return 1.0 - ns(due - now) / ns(allowed_gap); }
};

// The largest gap that a refresh allows. A point is read earlier than it must by `lead`, but by at
// most a tenth of its refresh. `refresh`: nanoseconds.
[[nodiscard]] constexpr Duration allowed_gap_of(double refresh, Duration lead) {
  const Duration whole{static_cast<Duration::rep>(refresh < 1e18 ? refresh : 1e18)};
  const Duration early = lead < whole / 10 ? lead : whole / 10;
  return whole - early > Duration{1} ? whole - early : Duration{1};
}

// Whether one read may not hold both `left` and `right`, its neighbour in address order.
[[nodiscard]] inline bool cut_between(const PlannedPoint& left, const PlannedPoint& right,
                                      Instant now) {
  return right.cut_until > now || left.bad || right.bad;
}

}  // namespace fieldcast
