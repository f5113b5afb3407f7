// What dispatching remembers between two reads: the state of every point and group, and the queues
// of groups. It is used with the plan in force, which is passed in. Copyable: a rehearsal runs on a
// copy. Owned by the plan runner, on the thread of its bus.
//
// A group that has something to read is in one of two queues: `held` while its read may not begin
// yet, `due` from then on. Besides it may be in `spare`, when it has use for wire time that would
// otherwise be rest, and in `asleep`, when it has points that are left alone for a while.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/dispatch/decision.hpp"
#include "core/dispatch/due_queue.hpp"
#include "core/dispatch/line_pace.hpp"
#include "core/plan/cycle.hpp"
#include "core/plan/read_plan.hpp"
#include "core/plan/wire_model.hpp"

namespace fieldcast {

struct GroupState {
  std::uint32_t urgent = 0;        // index within the group of the point that is due first
  std::uint32_t spare_urgent = 0;  // the first due of the points that want spare wire time
  Instant due = kNever;            // its next read
  Duration cost{};                 // the wire time of that read
  Cycle cycle;                     // of its reads
};

struct GroupQueues {
  explicit GroupQueues(std::size_t groups)
      : due(groups), held(groups), spare(groups), asleep(groups) {}
  void take_out(GroupIndex group);

  DueQueue due;     // by when it is due
  DueQueue held;    // by when its read may begin
  DueQueue spare;   // by when the first of its points for spare time is due
  DueQueue asleep;  // by when its first point wakes
};

struct DispatchState {
  DispatchState(WireModel model, std::span<const PlannedPoint> planned, const ReadPlan& plan);

  [[nodiscard]] std::span<PointState> points_of(const ReadPlan& plan, GroupIndex group);
  // The points that are read with the point `urgent`. `from`: the points of the group, real or
  // imagined.
  const Selection& select(const ReadPlan& plan, GroupIndex group, std::span<const PointState> from,
                          std::uint32_t urgent, Instant now, Duration budget);
  [[nodiscard]] Block make_block(const ReadPlan& plan, GroupIndex group, std::uint32_t urgent,
                                 Instant now, Duration budget);
  // A read for spare wire time, if there is one that takes at most `free`.
  [[nodiscard]] std::optional<Block> spare_read(const ReadPlan& plan, Instant now, Duration free);
  // When a point or device that is left alone comes back.
  [[nodiscard]] Instant next_wake() const;
  // Finds the most urgent points of a group, and puts it to sleep or in the queue for spare time.
  // Returns when its next read is due, kNever when there is nothing to read. The dispatcher puts it
  // into its own queue.
  [[nodiscard]] Instant find_urgent(const ReadPlan& plan, GroupIndex group, Instant now);

  // Sets when the next read of a group is due, and what it takes of the wire at the pace of its
  // device.
  void set_next_read(const ReadPlan& plan, GroupIndex group, Instant due, Instant now);

  WireModel wire;
  std::vector<PointState> points;        // by OrderIndex
  std::vector<GroupState> groups;        // as in the plan
  std::vector<LinePace> paces;           // by device
  std::vector<Instant> suspended_until;  // by device
  DueQueue suspended;                    // devices, by when they come back
  GroupQueues queues;
  ReadSelector selector;
};

}  // namespace fieldcast
