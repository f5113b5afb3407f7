// The scheduler: earliest deadline first over clusters, never pre-empted, with a look ahead that says how long the wire may rest.
//
// Three queues hold clusters: `due_` all that can be read, by the point whose time runs out first; `spare_` those that have use
// for wire time that would otherwise be rest (intensive, never read, failed); `asleep_` those with points that are left alone for
// a while. Owned by the bus engine and touched by it alone.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/schedule/block_shape.hpp"
#include "core/schedule/due_queue.hpp"
#include "core/schedule/layout.hpp"
#include "core/schedule/point_state.hpp"
#include "core/schedule/refusal.hpp"
#include "core/schedule/scheduler.hpp"

namespace fieldcast {

class RidingScheduler final : public Scheduler {
 public:
  RidingScheduler(const ScheduleInput& input, Planner planner, const RidingWeights& weights = {});

  Decision next(Instant now) override;
  void acquired(const Block& block, Instant acquired) override;
  void failed(const Block& block, Instant now, Instant retry_at) override;
  std::vector<PointIndex> refused(const Block& block, Instant now, Duration forget) override;
  void suspend(DeviceIndex device, Instant until) override;
  void set_answer_time(DeviceIndex device, Duration answer_time) override;
  [[nodiscard]] Duration slack(Instant now) override;
  void set_point(PointIndex point, Duration refresh, Mode mode, Instant now) override;
  [[nodiscard]] double planned_load() const override;
  [[nodiscard]] double stretch() const override { return stretch_; }

 private:
  // One of the next reads of a cluster, if each is made as late as possible.
  struct Coming {
    std::int64_t due = kNeverNs;
    std::int64_t cost = 0;
    bool again = false;  // its most urgent point was read by one of those before: due so much sooner as that was
  };
  static constexpr std::size_t kAgenda = 6;
  struct ClusterState {
    std::uint32_t urgent = 0;        // place within the cluster
    std::uint32_t spare_urgent = 0;  // the same among those that want spare wire time
    std::array<Coming, kAgenda> agenda;
    double load = 0;  // share of the wire that it needs, unstretched
  };
  struct DeviceState {
    std::int64_t suspended_until = 0;
    std::int64_t pause = 0;
  };
  // How much wire time is free before the earliest latest start.
  struct Slack {
    std::int64_t rest = 0;    // before anything must begin
    std::int64_t budget = 0;  // for the most urgent cluster's block, so that all others are still in time
  };

  void begin(std::int64_t now);
  void wake(std::int64_t now);
  [[nodiscard]] std::int64_t next_wake() const;
  [[nodiscard]] Slack look_ahead(std::int64_t now);
  [[nodiscard]] Slice shape(ClusterIndex cluster, std::span<const PointState> points, std::uint32_t urgent, std::int64_t now,
                            std::int64_t budget) const;
  [[nodiscard]] Block make_block(ClusterIndex cluster, std::uint32_t urgent, std::int64_t now, std::int64_t budget) const;

  void refresh_cluster(ClusterIndex cluster, std::int64_t now);
  void write_agenda(ClusterIndex cluster, std::int64_t now);
  void refresh_clusters_of(const Block& block, std::int64_t now);
  void postpone(PointState& point, std::int64_t from);
  void set_period(PointState& point) const;
  void set_stretch();
  [[nodiscard]] double cluster_load(ClusterIndex cluster) const;

  [[nodiscard]] std::span<PointState> points_of(ClusterIndex cluster) {
    return std::span(points_).subspan(layout_.clusters[cluster].begin,
                                      layout_.clusters[cluster].end - layout_.clusters[cluster].begin);
  }
  [[nodiscard]] std::span<const PointState> points_of(ClusterIndex cluster) const {
    return const_cast<RidingScheduler*>(this)->points_of(cluster);
  }
  [[nodiscard]] const ReadCost& cost_of(ClusterIndex cluster) const {
    return layout_.strips[layout_.clusters[cluster].strip].cost;
  }

  Planner planner_;
  RidingWeights weights_;
  std::int64_t lead_, silence_;
  Layout layout_;
  std::vector<PointState> points_;  // by place
  std::vector<ClusterState> clusters_;
  std::vector<DeviceState> devices_;
  DueQueue due_, spare_, asleep_;
  DueQueue suspended_;  // devices, by when they come back
  RefusalSearch refusals_;
  double load_ = 0;  // unstretched
  double stretch_ = 1;
  std::int64_t reserve_ = 0;
  bool begun_ = false;
  struct Ahead {
    std::int64_t due;
    std::uint32_t cluster;
    std::uint32_t slot;
    std::uint32_t step;  // in the agenda
  };
  std::vector<Ahead> ahead_;          // scratch of look_ahead()
  std::vector<PointState> imagined_;  // scratch of write_agenda()
};

}  // namespace fieldcast
