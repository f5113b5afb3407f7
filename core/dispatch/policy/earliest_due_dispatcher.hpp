// Earliest due first, without a timetable. For planners that only serve comparison.
#pragma once

#include <algorithm>

#include "core/dispatch/policy/look_ahead.hpp"

namespace fieldcast {

class EarliestDueDispatcher {
 public:
  [[nodiscard]] Decision next(const ReadPlan& plan, DispatchState& state, Instant now);
  [[nodiscard]] Duration slack(const ReadPlan& plan, const DispatchState& state, Instant now) {
    if (state.queues.due.empty()) return Duration::max();
    return std::max(Duration::zero(), look_ahead_.rest(plan, state, now));
  }
  void enqueue(const ReadPlan& plan, DispatchState& state, GroupIndex group, Instant due,
               Instant now) {
    look_ahead_.enqueue(plan, state, group, due, now);
  }
  void renew(const DispatchState&, const GroupState&, PointState& point, Instant acquired) const {
    LookAhead::renew(point, acquired);
  }
  void forget() {}

 private:
  LookAhead look_ahead_;
};

}  // namespace fieldcast
