// The planner: computes the load, stretches refreshes under overload, and makes the timetable. A
// lightly loaded bus gets a larger margin for noise and retries. Pure functions; any thread.
#pragma once

#include <span>
#include <vector>

#include "core/model/planner_choice.hpp"
#include "core/plan/read_plan.hpp"
#include "core/plan/wire_model.hpp"

namespace fieldcast {

// Planned load above which refreshes are stretched.
inline constexpr double kFullLoad = 1.0;

struct PlanBasis {
  const WireModel& wire;             // must outlive the basis
  std::vector<PlannedPoint> points;  // by OrderIndex
  double overrun = 1;                // factor by which the wire needs more than planned
  // By group: present read period, from which the load is estimated; empty if there is none.
  std::vector<Duration> periods;
};

[[nodiscard]] Grouping group_points(const PlanBasis& basis);

// The first plan is the one whose slots end first. Never empty.
[[nodiscard]] std::vector<ReadPlan> make_plans(PlanBasis basis, Grouping grouping);

[[nodiscard]] double load_of(const PlanBasis& basis, const ReadPlan& plan);

[[nodiscard]] Duration fastest_of(std::span<const PlannedPoint> points, Duration lead);

// Changed groups get phases in the present timetable; the reads of the others keep their slots and
// follow its order. `points`: by OrderIndex.
[[nodiscard]] ReadPlan amended(ReadPlan plan, const WireModel& wire,
                               std::span<const PointState> points,
                               std::span<const GroupIndex> changed);

struct PlannedLoad {
  double load = 0, stretch = 1;
};
[[nodiscard]] PlannedLoad planned_load_of(const ScheduleInput& input, Planner planner);

}  // namespace fieldcast
