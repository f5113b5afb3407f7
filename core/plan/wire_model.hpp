// Model of one bus for planner and dispatcher: layout of its points, costs of reads, and planning
// rules. Costs change with learned response times; the rest is fixed. A value; each copy belongs to
// one thread.
#pragma once

#include <vector>

#include "core/model/planner_choice.hpp"
#include "core/plan/layout/layout.hpp"
#include "core/plan/layout/point.hpp"
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

// By OrderIndex. A refresh below the wire time of its own read is raised to it.
[[nodiscard]] std::vector<PlannedPoint> planned_points(const ScheduleInput& input,
                                                       const Layout& layout);

[[nodiscard]] std::vector<std::uint32_t> bridges_of(const Layout& layout);

}  // namespace fieldcast
