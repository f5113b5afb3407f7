// Follows the timetable: selects the read that is due first; spare wire time is used for other
// reads. Holds only scratch memory.
#pragma once

#include <vector>

#include "core/dispatch/policy/dispatch_state.hpp"

namespace fieldcast {

class CyclicDispatcher {
 public:
  [[nodiscard]] Decision next(const ReadPlan& plan, DispatchState& state, Instant now);
  [[nodiscard]] Duration slack(const ReadPlan& plan, const DispatchState& state, Instant now) const;
  void enqueue(const ReadPlan& plan, DispatchState& state, GroupIndex group, Instant due,
               Instant now);
  // A point that was read early keeps its due time.
  void renew(const DispatchState& state, const GroupState& group, PointState& point,
             Instant acquired) const;
  void forget() {}

 private:
  [[nodiscard]] bool delays_another(const DispatchState& state, Instant due, Instant end);

  std::vector<std::size_t> walk_;  // scratch of delays_another()
};

}  // namespace fieldcast
