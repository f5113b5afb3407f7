// What to read next on one bus, and when. Pure: no clock, no I/O; every call gets `now`.
//
// The scheduler knows points (distinct item ranges that some channel needs) with their refreshes. A
// plan (core/plan) says which of them are read together, and when. Whenever the wire is free it
// answers one request: read this block now, or rest until then. It also notices when what was
// learned or asked for since may be worth another plan.
//
// Owned by the bus engine, on the thread of its bus. Nothing here fails.
#pragma once

#include <memory>
#include <vector>

#include "core/dispatch/decision.hpp"
#include "core/dispatch/plan_draft.hpp"
#include "core/dispatch/plan_runner.hpp"
#include "core/plan/planner.hpp"

namespace fieldcast {

class Scheduler {
 public:
  // REQUIRES: points name devices of the input and areas of their protocols. A refresh shorter than
  // the wire time of its own point counts as that time. A point that no request of its protocol can
  // carry is never read. Time begins with the first call of next().
  Scheduler(const ScheduleInput& input, Planner planner, const CyclicWeights& weights = {});

  // Somebody else has read the point before, at `acquired`: its first read is due a refresh later.
  // REQUIRES: before the first call of next().
  void inherit(PointIndex point, Instant acquired) { runner_.inherit(point, acquired); }
  // REQUIRES: the wire is free at `now`. Points whose device is paused until later are left out.
  [[nodiscard]] Decision next(Instant now) { return runner_.next(now); }
  // The points of the block were acquired at `acquired` (the answer's last byte).
  void acquired(const Block& block, Instant acquired);
  // The block failed for a reason that is not its addresses; its points stay due, tried again not
  // before `retry_at`.
  void failed(const Block& block, Instant now, Instant retry_at) {
    runner_.failed(block, now, retry_at);
  }
  // The device refused the block's addresses. More than one point: halves are read next, and a gap
  // between two good halves is remembered as not to be bridged. A single point: it is left alone
  // until now + forget. Returns the points that are now known to be bad (empty while the search
  // goes on).
  std::vector<PointIndex> refused(const Block& block, Instant now, Duration forget) {
    return runner_.refused(block, now, forget);
  }
  // No reads of this device before `until` (offline, pausing); kNever stops it.
  void suspend(DeviceIndex device, Instant until) { runner_.suspend(device, until); }
  // Learned of the device: what reads of an area take until the answer begins, and the longest of
  // them that it accepts (items; 0: no other than the configured).
  void set_answer_time(DeviceIndex device, AreaIndex area, Duration answer_time);
  void set_longest(DeviceIndex device, AreaIndex area, std::uint32_t items);
  // How long the wire may be blocked from `now` on by something else (a probe of a silent device)
  // without making a point late that would otherwise be in time. Zero when there is none to spare.
  [[nodiscard]] Duration slack(Instant now) { return runner_.slack(now); }
  // Another refresh or mode for a point, effective at once (interest, overload).
  void set_point(PointIndex point, Duration refresh, Mode mode, Instant now);

  // What was learned and asked for since the plan in force was made may be worth another one; to be
  // made on another thread. Null: nothing has changed, or a draft is out.
  [[nodiscard]] std::unique_ptr<PlanDraft> draft();
  // Puts the plan of a draft in force. REQUIRES: the last draft of this scheduler, made.
  void adopt(PlanDraft& draft, Instant now);

  [[nodiscard]] const ReadPlan& plan() const { return runner_.plan(); }
  // Share of the wire that the plan needs in the long run, 0..; above 1 is overload.
  [[nodiscard]] double planned_load() const { return load_ * plan().fit; }
  // Factor by which overload stretches all refreshes at present; 1 without overload.
  [[nodiscard]] double stretch() const { return plan().stretch; }

 private:
  PlanRunner runner_;
  double load_;                             // of what is asked for
  std::vector<std::uint32_t> grouped_for_;  // what reads could bridge when groups were made
  bool stale_ = false;                      // another plan may be needed
  bool costs_changed_ = false;              // other groups may be needed
  bool drafting_ = false;                   // a draft is out
};

// Makes a new plan during the call, if one is due: for callers in virtual time.
void replan(Scheduler& scheduler, Instant now);

[[nodiscard]] std::unique_ptr<Scheduler> make_scheduler(const ScheduleInput& input,
                                                        Planner planner = Planner::kCyclic);

}  // namespace fieldcast
