// What a planner and a dispatcher know of one bus and its devices: where its points lie, what reads
// cost, and by which rules it is planned. Costs change as answers are learned; all else is fixed.
// A value; each copy belongs to one thread.
#pragma once

#include <vector>

#include "core/plan/layout.hpp"
#include "core/plan/point.hpp"
#include "core/plan/shape/point_state.hpp"
#include "core/plan/shape/read_selector.hpp"

namespace fieldcast {

// One row for each planner.
struct PlanRules {
  GroupingRule grouping;
  ShapeRule shape;
  bool timetable;  // reads have slots
};
[[nodiscard]] PlanRules rules_of(Planner planner);

struct WireModel {
  // REQUIRES: points name devices of the input and areas of their protocols.
  WireModel(const ScheduleInput& input, Planner planner, const CyclicWeights& weights = {});

  Planner planner;
  PlanRules rules;
  CyclicWeights weights;
  Duration lead, silence;
  std::vector<Duration> tails;  // by device: from the end of its answer until the wire is free
  Layout layout;

  // Changes the cost of every read of an area; false: nothing is read there.
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

// The points by OrderIndex. An absurd refresh would stretch everybody else's: none is shorter than
// the wire time of its own read.
[[nodiscard]] std::vector<PlannedPoint> planned_points(const ScheduleInput& input,
                                                       const Layout& layout);

// How many items a read may bridge, by area run. Groups are worth making anew where it changes
// much.
[[nodiscard]] std::vector<std::uint32_t> bridges_of(const Layout& layout);

}  // namespace fieldcast
