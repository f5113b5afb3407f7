// State of dispatching between two reads: every point and group, and the queues of groups. The plan
// in force is passed to each call. Copyable: a rehearsal runs on a copy. Owned by the plan runner,
// on the thread of its bus.
//
// A group with points to read is in one of two queues: `held` until its read may begin, then `due`.
// It may also be in `spare`, if it can use spare wire time, and in `asleep`, if some of its points
// are paused.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/dispatch/policy/decision.hpp"
#include "core/dispatch/policy/due_queue.hpp"
#include "core/dispatch/policy/line_pace.hpp"
#include "core/plan/cycle.hpp"
#include "core/plan/read_plan.hpp"
#include "core/plan/wire_model.hpp"

namespace fieldcast {

struct GroupState {
  std::uint32_t urgent = 0;        // index within the group of the point that is due first
  std::uint32_t spare_urgent = 0;  // the first due of the points for spare wire time
  Instant due = kNever;            // its next read
  Duration cost{};                 // wire time of that read
  Cycle cycle;                     // of its reads
};

struct GroupQueues {
  explicit GroupQueues(std::size_t groups)
      : due(groups), held(groups), spare(groups), asleep(groups) {}
  void take_out(GroupIndex group);

  DueQueue due;     // by due time
  DueQueue held;    // by earliest start
  DueQueue spare;   // by due time of its first point for spare time
  DueQueue asleep;  // by wake-up time of its first point
};

struct DispatchState {
  DispatchState(WireModel model, std::span<const PlannedPoint> planned, const ReadPlan& plan);

  [[nodiscard]] std::span<PointState> points_of(const ReadPlan& plan, GroupIndex group);
  // `from`: points of the group, real or simulated.
  const Selection& select(const ReadPlan& plan, GroupIndex group, std::span<const PointState> from,
                          std::uint32_t urgent, Instant now, Duration budget);
  [[nodiscard]] Block make_block(const ReadPlan& plan, GroupIndex group, std::uint32_t urgent,
                                 Instant now, Duration budget);
  // Needs at most `free`; empty if there is none.
  [[nodiscard]] std::optional<Block> spare_read(const ReadPlan& plan, Instant now, Duration free);
  [[nodiscard]] Instant next_wake() const;
  // Updates `asleep` and `spare`. Returns the due time of the group's next read; kNever if none.
  [[nodiscard]] Instant find_urgent(const ReadPlan& plan, GroupIndex group, Instant now);

  // Computes the wire time at the pace of the device.
  void set_next_read(const ReadPlan& plan, GroupIndex group, Instant due, Instant now);

  WireModel wire;
  std::vector<PointState> points;        // by OrderIndex
  std::vector<GroupState> groups;        // as in the plan
  std::vector<LinePace> paces;           // by device
  std::vector<Instant> suspended_until;  // by device
  DueQueue suspended;                    // devices, by end of their pause
  GroupQueues queues;
  ReadSelector selector;
};

}  // namespace fieldcast
