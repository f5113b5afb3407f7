// State of a point for planning and dispatching. Plain values.
#pragma once

#include <cstdint>

#include "core/model/channel_kind.hpp"
#include "core/plan/layout/time_math.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

// The part that determines a plan: requirements, and refusals of the device.
struct PlannedPoint {
  std::uint32_t first = 0, end = 1;  // items first .. end-1
  AreaIndex area = 0;
  Mode mode = Mode::kScheduled;
  std::int8_t priority = 0;
  float elasticity = 1;
  bool readable = true;       // some request can read it
  bool bad = false;           // the device refuses it, even alone
  Duration refresh{};         // as requested, but at least `least_refresh`
  Duration least_refresh{1};  // wire time of a read of this point alone
  double stretch = 1;         // factor on the refresh under overload
  Instant cut_until{};  // until then no read may hold this point together with the previous one

  [[nodiscard]] bool wanted() const { return readable && mode != Mode::kOnDemand; }
};

// The part that changes with every real or simulated read.
struct PointState : PlannedPoint {
  bool eager = true;          // read as soon as the wire is idle: never read yet, or failed
  bool again = false;         // only in a simulated run: it was read before
  bool suspect = false;       // part of a refused read whose halves are being tried
  Duration allowed_gap{1};    // present largest gap: stretched refresh minus lead
  Instant due = kNever;       // when it should be read again
  Instant deadline = kNever;  // end of the allowed gap; not before `due`
  Instant retry_at{};         // not read before this time
  Duration period{};          // zero without a cycle

  [[nodiscard]] bool ready(Instant now) const { return wanted() && retry_at <= now; }
  // Used share of the allowed gap: 0 just read, 1 due.
  [[nodiscard]] double used(Instant now) const { return 1.0 - ns(due - now) / ns(allowed_gap); }
};

// A point is read early by `lead`, at most a tenth of its refresh. `refresh`: nanoseconds.
[[nodiscard]] constexpr Duration allowed_gap_of(double refresh, Duration lead) {
  const Duration whole{static_cast<Duration::rep>(refresh < 1e18 ? refresh : 1e18)};
  const Duration early = lead < whole / 10 ? lead : whole / 10;
  return whole - early > Duration{1} ? whole - early : Duration{1};
}

// `right`: neighbour of `left` in address order.
[[nodiscard]] inline bool cut_between(const PlannedPoint& left, const PlannedPoint& right,
                                      Instant now) {
  return right.cut_until > now || left.bad || right.bad;
}

}  // namespace fieldcast
