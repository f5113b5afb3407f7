// The scheduler: of the reads that may begin, the one that is due first, never pre-empted.
//
// Each cluster has its beat and its points their turns by a timetable (timetable.hpp); slower
// points ride along with the reads of the cluster (block_shape.hpp; list_shape.hpp where a request
// carries a list of ranges). Four queues hold clusters: `held_` those whose read may not begin yet;
// `due_` those whose may; `spare_` those that have use for wire time that would otherwise be rest
// (intensive, never read, failed); `asleep_` those with points that are left alone for a while.
// README.md beside this file tells what was tried. Owned by the bus engine and touched by it alone.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/schedule/block_shape.hpp"
#include "core/schedule/due_queue.hpp"
#include "core/schedule/layout.hpp"
#include "core/schedule/line_pace.hpp"
#include "core/schedule/list_shape.hpp"
#include "core/schedule/pick.hpp"
#include "core/schedule/point_state.hpp"
#include "core/schedule/refusal.hpp"
#include "core/schedule/rhythm.hpp"
#include "core/schedule/scheduler.hpp"
#include "core/schedule/timetable.hpp"

namespace fieldcast {

class RidingScheduler final : public Scheduler {
 public:
  // `proven`: of several plans the one is taken that keeps every refresh when it is rehearsed. That
  // takes longer; where only loads are asked for it is not worth it.
  RidingScheduler(const ScheduleInput& input, Planner planner, bool proven,
                  const RidingWeights& weights = {});

  Decision next(Instant now) override;
  void acquired(const Block& block, Instant acquired) override;
  void failed(const Block& block, Instant now, Instant retry_at) override;
  std::vector<PointIndex> refused(const Block& block, Instant now, Duration forget) override;
  void suspend(DeviceIndex device, Instant until) override;
  void set_answer_time(DeviceIndex device, AreaIndex area, Duration answer_time) override;
  void set_longest(DeviceIndex device, AreaIndex area, std::uint32_t items) override;
  [[nodiscard]] Duration slack(Instant now) override;
  void set_point(PointIndex point, Duration refresh, Mode mode, Instant now) override;
  [[nodiscard]] std::unique_ptr<PlanDraft> draft() override;
  void adopt(PlanDraft& draft, Instant now) override;
  [[nodiscard]] double planned_load() const override { return load_ * fit_; }
  [[nodiscard]] double stretch() const override { return stretch_; }

 private:
  // One of the next reads of a cluster, if each is made as late as possible.
  struct Coming {
    std::int64_t due = kNeverNs;
    std::int64_t cost = 0;
    bool again = false;  // its most urgent point was read by one of those before: due so much
                         // sooner as that was
  };
  static constexpr std::size_t kAgenda = 6;
  struct ClusterState {
    std::uint32_t urgent = 0;        // place within the cluster of the point that is due first,
    std::uint32_t spare_urgent = 0;  // and that is due first among those that want spare wire time
    std::array<Coming, kAgenda> agenda;
    Beat beat;
  };
  struct Draft;
  // How much wire time is free before the earliest latest start.
  struct Slack {
    std::int64_t rest = 0;  // before anything must begin
    std::int64_t budget =
        0;  // for the most urgent cluster's block, so that it and all others are still in time
    bool tight = false;  // none to spare
  };
  static constexpr std::uint32_t kNoSlot = (1u << 28) - 1;
  struct Ahead {  // small: heaps of it are what a decision costs
    std::int64_t due;
    ClusterIndex cluster;
    std::uint32_t slot : 28;  // in the queue; kNoSlot: a repetition
    std::uint32_t step : 4;   // in the agenda
  };

  static constexpr double kFull = 1.0;  // planned load from which on refreshes are stretched

  // riding_plan.cpp: what is worked out once, and in drafts
  void plan();
  void cut();
  void find_fastest();
  [[nodiscard]] double margin() const;
  void stretch_by(double factor);
  [[nodiscard]] double cluster_load(ClusterIndex cluster, bool stretched);
  [[nodiscard]] double total_load(bool stretched);
  void spread(std::int64_t began);
  [[nodiscard]] TimetableRequest entry_of(ClusterIndex cluster) const;
  [[nodiscard]] std::int64_t base_of(ClusterIndex cluster) const;
  void take_turns(ClusterIndex cluster);
  void make_timetable();
  void fit(double factor);
  void begin(std::int64_t now);
  void set_period(PointState& point) const;
  void watch_lateness(bool late, std::int64_t now);

  // riding_changes.cpp: what changes while the wire runs
  template <typename Change>
  void change_cost(DeviceIndex device, AreaIndex area, const Change& change);
  void touch(Place place);
  void settle_changes(std::int64_t now);
  void make_plan();
  [[nodiscard]] bool cut_anew();
  [[nodiscard]] bool worth_cutting();

  // riding_draft.cpp: plans that are proven before they go into force
  static constexpr std::uint64_t kAnyNumber = ~std::uint64_t{0};
  [[nodiscard]] std::uint64_t rehearse(std::int64_t now, std::uint64_t enough);
  [[nodiscard]] std::uint64_t late_in(const Block& block, std::int64_t acquired) const;
  [[nodiscard]] std::int64_t latest_for(const PointState& point) const;
  void prove();
  void forget_paces(std::int64_t now);
  void take(RidingScheduler&& plan, std::int64_t began, std::int64_t now);
  void find_turns(std::int64_t now);

  // riding_scheduler.cpp: decisions
  [[nodiscard]] Decision decide(std::int64_t now);
  [[nodiscard]] Decision decide_ahead(std::int64_t now);
  [[nodiscard]] bool in_the_way(std::int64_t due, std::int64_t end);
  void wake(std::int64_t now);
  [[nodiscard]] std::int64_t next_wake() const;
  [[nodiscard]] Slice slice_of(ClusterIndex cluster, std::span<const PointState> points,
                               std::uint32_t urgent, std::int64_t now, std::int64_t budget) const;
  // Who is read with the urgent point at `now`: into pick_.
  const Pick& shape(ClusterIndex cluster, std::span<const PointState> points, std::uint32_t urgent,
                    std::int64_t now, std::int64_t budget);
  [[nodiscard]] Block make_block(ClusterIndex cluster, std::uint32_t urgent, std::int64_t now,
                                 std::int64_t budget);
  [[nodiscard]] Decision next_of_batch(std::int64_t now);

  [[nodiscard]] std::int64_t next_due(ClusterIndex cluster, const PointState& point,
                                      std::int64_t acquired) const;
  void renew(ClusterIndex cluster, PointState& point, std::int64_t at) const;
  void postpone(PointState& point, std::int64_t from) const;

  void refresh_clusters_of(const Block& block, std::int64_t now);

  // riding_outlook.cpp: what comes next
  [[nodiscard]] Slack look_ahead(std::int64_t now);
  void refresh_cluster(ClusterIndex cluster, std::int64_t now);
  void write_agenda(ClusterIndex cluster, std::int64_t now);
  [[nodiscard]] std::int64_t room_of(ClusterIndex cluster, const PointState& head) const;
  void take_out(ClusterIndex cluster);

  [[nodiscard]] std::span<PointState> points_of(ClusterIndex cluster) {
    const Cluster& from = layout_.clusters[cluster];
    return std::span(points_).subspan(from.begin, from.end - from.begin);
  }
  [[nodiscard]] std::span<const PointState> points_of(ClusterIndex cluster) const {
    const Cluster& from = layout_.clusters[cluster];
    return std::span(points_).subspan(from.begin, from.end - from.begin);
  }
  // REQUIRES: not a pack.
  [[nodiscard]] const ReadCost& cost_of(ClusterIndex cluster) const {
    return layout_.strips[layout_.clusters[cluster].strip].cost;
  }
  [[nodiscard]] const ListCost& list_cost_of(ClusterIndex cluster) const {
    return *layout_.lists[layout_.clusters[cluster].device];
  }

  Planner planner_;
  RidingWeights weights_;
  std::int64_t lead_, silence_;
  std::vector<std::int64_t> tails_;  // by device: from the end of its answer until the wire is free
  std::vector<LinePace> paces_;      // by device
  std::int64_t asked_ = 0;           // when the last block was given out
  Layout layout_;
  std::vector<PointState> points_;  // by place
  std::vector<ClusterState> clusters_;
  std::vector<std::int64_t> suspended_until_;  // by device
  DueQueue due_, spare_, asleep_;
  DueQueue held_;       // by when they may be read
  DueQueue suspended_;  // devices, by when they come back
  RefusalSearch refusals_;
  Timetable table_{1, 0};
  std::vector<Timetable> ways_;  // of a plan just made: other timetables for it, best first
  std::int64_t table_began_ = 0;
  std::int64_t settled_at_ = 0;  // then every point has found its turn on the table
  std::int64_t seen_ = 0;        // the latest instant told
  std::vector<Block> batch_;     // kDynamicBlocks: what is still to be read, last first
  double load_ = 0;              // unstretched,
  double fit_ = 1;               // and how much more the timetable takes
  double stretch_ = 1;           // the greatest of all points
  double least_elasticity_ = 1;
  bool uneven_ = false;  // not every elasticity is 1
  std::size_t priorities_ = 1;
  double overrun_ = 1;      // how much more the wire needs than planned
  double planned_for_ = 0;  // load and overrun of the plan in force
  std::int64_t reserve_ =
      0;             // of planners without a timetable: the rest ends this much before it must
  double room_ = 1;  // 0 on a crowded wire, 1 on a light one
  std::int64_t fastest_ = 1;  // period of the bus
  std::uint32_t late_ = 0, watched_ = 0;
  std::int64_t window_began_ = 0, rested_ = 0, rests_since_ = kNeverNs;
  std::vector<ClusterIndex> changed_;  // to be given other turns
  std::vector<Place> touched_;         // of what changed since the draft was begun
  std::vector<std::uint32_t>
      cut_at_;                  // what a read may bridge, by strip, when the clusters were cut
  bool stale_ = false;          // a new plan may be needed
  bool costs_changed_ = false;  // clusters may have to be cut anew
  bool drafting_ = false;       // a draft is out
  // Of a draft that was made: whether there is a new plan, and other clusters.
  bool planned_ = false, cut_ = false;
  bool begun_ = false;
  std::vector<Ahead> ahead_;          // scratch of look_ahead()
  std::vector<std::size_t> walk_;     // scratch of in_the_way()
  std::vector<PointState> imagined_;  // scratch of write_agenda() and cluster_load()
  ListShaper lists_;
  Pick pick_;                  // of shape()
  std::vector<Place> places_;  // scratch of refused()
};

}  // namespace fieldcast
