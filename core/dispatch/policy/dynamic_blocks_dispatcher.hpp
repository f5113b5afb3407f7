// A simple algorithm for comparison: reads up to twenty of the most urgent groups, then selects
// again.
#pragma once

#include <algorithm>
#include <vector>

#include "core/dispatch/policy/look_ahead.hpp"

namespace fieldcast {

class DynamicBlocksDispatcher {
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
  void forget() { batch_.clear(); }

 private:
  void fill(const ReadPlan& plan, DispatchState& state, Instant now);

  static constexpr std::size_t kMostBatch = 20;
  LookAhead look_ahead_;
  std::vector<Block> batch_;  // last first
};

}  // namespace fieldcast
