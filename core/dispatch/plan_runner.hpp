// Estimates how much more wire time reads need than planned, from points that are late although the
// wire never rests. Plain value.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/dispatch/policy/decision.hpp"
#include "core/dispatch/policy/dispatch_state.hpp"
#include "core/dispatch/policy/dispatcher.hpp"
#include "core/plan/layout/layout.hpp"
#include "core/plan/layout/time_math.hpp"
#include "core/plan/planner.hpp"
#include "core/plan/shape/point_state.hpp"

namespace fieldcast {

class OverrunWatch {
 public:
  // `rests`: from `now` on.
  void wire_free(Instant now, bool rests);
  void acquired(bool late, Instant now);
  // A plan took effect. Late points before `settled` do not count.
  void plan_began(Instant settled) { settled_at_ = settled; }

  // 1: as planned; at most kMost.
  [[nodiscard]] double overrun() const { return overrun_; }

 private:
  static constexpr double kMost = 16;
  double overrun_ = 1;
  Instant settled_at_{};
  // Counters of the present window of acquisitions.
  std::uint32_t late_ = 0, watched_ = 0;
  Instant window_began_{};
  Duration rested_{};
  Instant rests_since_ = kNever;
};

// Finds the part of a block that a device refuses. A refused block is cut in the middle
// (PointState::cut_until), so that normal scheduling reads its halves, until the bad points are
// known. The cut is removed when every point of the block was acquired or found bad. If both halves
// were good, the device refused the gap between them, and the cut stays until it expires. Owned by
// the plan runner.
class RefusalSearch {
 public:
  // `refused`: at least two points in ascending order.
  void cut(std::span<PointState> points, std::span<const OrderIndex> refused, Instant now,
           Duration forget);
  // Excludes one point until now + forget.
  void mark_bad(std::span<PointState> points, OrderIndex index, Instant now, Duration forget);
  // Points begin .. end-1 were acquired or found bad.
  void settle(std::span<PointState> points, OrderIndex begin, OrderIndex end);

  [[nodiscard]] bool searching() const { return !open_.empty(); }

 private:
  struct Node {
    OrderIndex begin, middle, end;
    bool half_refused = false;
  };
  // With more open searches, the oldest ends as if both halves were good.
  static constexpr std::size_t kMostOpen = 256;
  std::vector<Node> open_;
};

// Executes the plan in force on one wire: tracks when each point was read and is due again, and
// requests the next read from the dispatcher. Changes apply immediately to the present plan;
// another plan replaces it as a whole. Copyable for rehearsals. Owned by the scheduler, on the
// thread of its bus.
class PlanRunner {
 public:
  PlanRunner(WireModel wire, std::span<const PlannedPoint> points, ReadPlan plan);

  // See scheduler.hpp.
  void inherit(PointIndex point, Instant acquired);
  [[nodiscard]] Decision next(Instant now);
  void acquired(const Block& block, Instant acquired);
  void launched(const Block& block, Instant now);
  void confirmed(const Block& block, Instant acquired);
  void failed(const Block& block, Instant now, Instant retry_at);
  std::vector<PointIndex> refused(const Block& block, Instant now, Duration forget);
  void suspend(DeviceIndex device, Instant until);
  [[nodiscard]] Duration slack(Instant now);
  void set_point(PointIndex point, const Point& wanted, Instant now);
  // Returns false if no read uses the area.
  bool set_response_time(DeviceIndex device, AreaIndex area, Duration response_time);
  bool set_longest(DeviceIndex device, AreaIndex area, std::uint32_t items);

  // Every point gets the last of its instants within its allowed gap, as if the table, which starts
  // at `began`, had always been used.
  void adopt(ReadPlan plan, Instant began, Instant now);
  // Records changed points, which the plan being made does not include.
  void remember_changes() { remembered_.emplace(); }
  void forget_changes() { remembered_.reset(); }
  // Resets every line to its nominal rate, until it is measured again.
  void forget_paces(Instant now);

  [[nodiscard]] PlanBasis basis() const;
  [[nodiscard]] const ReadPlan& plan() const { return plan_; }
  [[nodiscard]] const WireModel& wire() const { return state_.wire; }
  [[nodiscard]] std::span<const PointState> points() const { return state_.points; }
  [[nodiscard]] const PointState& point(PointIndex point) const {
    return state_.points[state_.wire.layout.index_of[point]];
  }
  [[nodiscard]] Instant table_began() const { return state_.table_began; }
  [[nodiscard]] Instant last_seen() const { return seen_; }
  [[nodiscard]] double overrun() const { return watch_.overrun(); }

 private:
  void begin(Instant now);
  void wake(Instant now);
  void set_plan(ReadPlan plan);
  void set_allowed_gap(PointState& point) const;
  void take_phases(GroupIndex group);
  void find_instants(Instant now);
  void touch(OrderIndex index);
  bool touch_area(DeviceIndex device, AreaIndex area, bool is_read);
  void settle_changes(Instant now);
  void forget_decisions();
  template <typename D>
  void renew(const Block& block, Instant now, const D& dispatcher);
  void settle_refusals(const Block& block);
  static void postpone(PointState& point, Instant from);
  void refresh(GroupIndex group, Instant now);
  void refresh_all(Instant now);
  void refresh_groups_of(const Block& block, Instant now);
  [[nodiscard]] OrderIndex index_of(PointIndex point) const {
    return state_.wire.layout.index_of[point];
  }

  ReadPlan plan_;
  DispatchState state_;
  Dispatcher dispatcher_;
  RefusalSearch refusals_;
  OverrunWatch watch_;
  bool begun_ = false;
  Instant decided_{};                // time of the last block
  Instant seen_{};                   // the latest time passed
  std::vector<GroupIndex> changed_;  // the plan is amended for them when the wire is free
  std::optional<std::vector<OrderIndex>> remembered_;
  std::vector<OrderIndex> refused_;                        // scratch of refused()
  std::vector<std::pair<OrderIndex, Instant>> inherited_;  // until the first call of next()
};

}  // namespace fieldcast
