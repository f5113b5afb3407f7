// The planner: points and what they cost -> a plan. Pure functions; any thread.
//
// It finds the load, stretches refreshes under overload, and makes the timetable. Reads of a bus
// with little load are planned with a larger margin, so that noise and retries find time.
#pragma once

#include <span>
#include <vector>

#include "core/plan/read_plan.hpp"
#include "core/plan/wire_model.hpp"

namespace fieldcast {

// Planned load from which on refreshes are stretched.
inline constexpr double kFullLoad = 1.0;

// What a plan follows from.
struct PlanBasis {
  const WireModel& wire;             // outlives the basis
  std::vector<PlannedPoint> points;  // by OrderIndex
  double overrun = 1;                // how much more the wire needs than planned
  // By group: the period at which it is read at present; empty: none is. The load is estimated from
  // reads of that shape.
  std::vector<Duration> periods;
};

// Groups by the present costs.
[[nodiscard]] Grouping group_points(const PlanBasis& basis);

// The plan for these groups and, where a timetable can be filled in several ways, the others that
// were tried. Those whose slots end soonest come first. Never empty.
[[nodiscard]] std::vector<ReadPlan> make_plans(PlanBasis basis, Grouping grouping);

// The load of what is asked for now, if the groups and the margin of `plan` stay.
[[nodiscard]] double load_of(const PlanBasis& basis, const ReadPlan& plan);

// The smallest allowed gap of all scheduled points, stretched as they are.
[[nodiscard]] Duration fastest_of(std::span<const PlannedPoint> points, Duration lead);

// What becomes of the groups that have not changed: they keep the instants at which they are read,
// or follow the timetable, in which reads end sooner or later by the change.
enum class OtherGroups : std::uint8_t { kStay, kFollow };

// The plan with other refreshes, modes or costs of some groups, which get phases in the timetable
// as it is. `points`: by OrderIndex.
[[nodiscard]] ReadPlan amended(ReadPlan plan, const WireModel& wire,
                               std::span<const PointState> points,
                               std::span<const GroupIndex> changed, OtherGroups others);

// The load of a plan and how far it stretches refreshes, without the plan.
struct PlannedLoad {
  double load = 0, stretch = 1;
};
[[nodiscard]] PlannedLoad planned_load_of(const ScheduleInput& input, Planner planner);

}  // namespace fieldcast
