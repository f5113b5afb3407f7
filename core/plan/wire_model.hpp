// Model of one bus for planner and dispatcher: layout of its points, costs of reads, and planning
// rules. Costs change with learned response times. A value; each copy belongs to one thread.
#pragma once

#include <span>
#include <vector>

#include "core/model/planner_choice.hpp"
#include "core/plan/layout/cost.hpp"
#include "core/plan/layout/layout.hpp"
#include "core/plan/shape/point_state.hpp"
#include "core/plan/shape/read_selector.hpp"

namespace fieldcast {

struct PlanRules {
  GroupingRule grouping;
  ShapeRule shape;
  bool timetable;  // reads have slots
};
[[nodiscard]] PlanRules rules_of(Planner planner);

struct WireModel {
  WireModel(const ScheduleInput& input, Planner planner, const CyclicWeights& weights = {});

  Planner planner;
  PlanRules rules;
  CyclicWeights weights;
  Duration lead, silence;
  std::vector<Duration> tails;  // by device: from the end of its response until the wire is free
  Layout layout;

  // Returns false if no read uses the area.
  template <typename Change>
  bool change_cost(DeviceIndex device, AreaIndex area, const Change& change) {
    bool read = false;
    for (AreaRun& run : layout.area_runs) {
      if (run.device != device || run.area != area) continue;
      change(run.cost);
      read = true;
    }
    return read;
  }
};

// Sets mode, refresh, priority and elasticity. A refresh below the wire time of its own read is
// raised to it.
void require(PlannedPoint& point, const Point& wanted);

// By OrderIndex.
[[nodiscard]] std::vector<PlannedPoint> planned_points(const ScheduleInput& input,
                                                       const Layout& layout);

[[nodiscard]] std::vector<std::uint32_t> bridges_of(const Layout& layout);

// Computes the share of the wire of one group by simulating its reads. Holds scratch memory.
class GroupLoad {
 public:
  explicit GroupLoad(const WireModel& wire)
      : wire_(wire), selector_(wire.rules.shape, wire.weights) {}

  struct Terms {
    Duration period{};       // present period of the group; zero if none
    Duration fastest{1};     // smallest allowed gap of the bus
    double margin = 0;       // of the bus
    bool stretched = false;  // uses stretched refreshes instead of requested ones
  };
  // As if the group were alone on the wire. `points`: those of the group.
  [[nodiscard]] double of(const Group& group, std::span<const PlannedPoint> points,
                          const Terms& terms);

 private:
  void imagine(std::span<const PlannedPoint> points, bool stretched);
  [[nodiscard]] std::uint32_t most_urgent() const;

  const WireModel& wire_;
  ReadSelector selector_;
  std::vector<PointState> imagined_;
};

}  // namespace fieldcast
