// Selects the next read of one bus. Pure; every call gets `now`. It has points (distinct item
// ranges required by channels) with their refreshes, and a plan (core/plan) that defines which are
// read together, and when. Whenever the wire is free it returns a block to read, or a time to rest
// until. It also detects when changes may justify another plan. Owned by the bus engine, on the
// thread of its bus.
#pragma once

#include <memory>
#include <vector>

#include "core/dispatch/headroom.hpp"
#include "core/dispatch/plan_draft.hpp"
#include "core/dispatch/plan_runner.hpp"
#include "core/dispatch/policy/decision.hpp"
#include "core/plan/planner.hpp"

namespace fieldcast {

class Scheduler {
 public:
  // REQUIRES: points name devices of the input and areas of their protocols. A refresh below the
  // wire time of its own point is raised to it. A point that no request can read is never read.
  // Time starts with the first call of next().
  Scheduler(const ScheduleInput& input, Planner planner, const CyclicWeights& weights = {});

  // Another bridge has read the point at `acquired`. REQUIRES: before the first call of next().
  void inherit(PointIndex point, Instant acquired) { runner_.inherit(point, acquired); }
  // REQUIRES: the wire is free at `now`. Omits points of paused devices.
  [[nodiscard]] Decision next(Instant now) { return runner_.next(now); }
  // `acquired`: last byte of the response.
  void acquired(const Block& block, Instant acquired);
  // With several requests in flight, instead of acquired(): at the request, then at the response.
  void launched(const Block& block, Instant now);
  void confirmed(const Block& block, Instant acquired) { runner_.confirmed(block, acquired); }
  // The cause is not the addresses. The points are tried again at `retry_at` or later.
  void failed(const Block& block, Instant now, Instant retry_at) {
    runner_.failed(block, now, retry_at);
  }
  // The device refused the block's addresses. Several points: reads halves next, and does not
  // bridge a gap between two good halves. A single point: excludes it until now + forget. Returns
  // the points now known to be bad.
  std::vector<PointIndex> refused(const Block& block, Instant now, Duration forget) {
    return runner_.refused(block, now, forget);
  }
  // No reads of this device before `until` (offline, pausing); kNever stops them.
  void suspend(DeviceIndex device, Instant until) { runner_.suspend(device, until); }
  // Learned values: response time; longest accepted read in items (0: as configured).
  void set_response_time(DeviceIndex device, AreaIndex area, Duration response_time);
  void set_longest(DeviceIndex device, AreaIndex area, std::uint32_t items);
  // How long the wire may be blocked from `now` on without delaying a point, as by a probe.
  [[nodiscard]] Duration slack(Instant now) { return runner_.slack(now); }
  // Whether the next reads are in time after the wire was used otherwise for `use`.
  [[nodiscard]] bool has_headroom(Instant now, Duration use) const {
    return fieldcast::has_headroom(runner_, now, use);
  }
  // Requirements of a point: its refresh, mode, priority and elasticity.
  void set_point(PointIndex point, const Point& wanted, Instant now);

  // To be made on another thread. Null if there are no changes, or a draft is pending.
  [[nodiscard]] std::unique_ptr<PlanDraft> draft();
  // REQUIRES: the last draft of this scheduler, complete.
  void adopt(PlanDraft& draft, Instant now);

  [[nodiscard]] const ReadPlan& plan() const { return runner_.plan(); }
  // Share of the wire that the plan needs in the long run; above 1 is overload.
  [[nodiscard]] double planned_load() const { return load_ * plan().fit; }
  // Factor on all refreshes; 1 without overload.
  [[nodiscard]] double stretch() const { return plan().stretch; }

 private:
  PlanRunner runner_;
  double load_;                             // of the present requests
  std::vector<std::uint32_t> grouped_for_;  // bridgeable items when the groups were made
  bool stale_ = false;                      // another plan may be needed
  bool costs_changed_ = false;              // other groups may be needed
  bool drafting_ = false;                   // a draft is pending
};

// For virtual time: makes a new plan during the call, if one is due.
void replan(Scheduler& scheduler, Instant now);

[[nodiscard]] std::unique_ptr<Scheduler> make_scheduler(const ScheduleInput& input,
                                                        Planner planner = Planner::kCyclic);

}  // namespace fieldcast
