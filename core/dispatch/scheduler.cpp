#include "core/dispatch/scheduler.hpp"

#include <utility>

#include "core/dispatch/plan_draft.hpp"

namespace fieldcast {

namespace {

// The first plan whose rehearsal keeps every refresh; otherwise the one that breaks the fewest.
ReadPlan proven(std::vector<ReadPlan> plans, const WireModel& wire,
                std::span<const PlannedPoint> points) {
  constexpr Instant kStart{std::chrono::seconds{1}};
  const ReadPlan& first = plans.front();
  if (!first.table || first.stretch > 1 || first.table->empty()) return std::move(plans.front());
  std::uint64_t least = kAnyNumber;
  std::size_t best = 0;
  for (std::size_t i = 0; i < plans.size() && least > 0; ++i) {
    const std::uint64_t late = count_late(PlanRunner(wire, points, plans[i]), kStart, least);
    if (late < least) least = late, best = i;
  }
  return std::move(plans[best]);
}

PlanRunner first_runner(const ScheduleInput& input, Planner planner, const CyclicWeights& weights) {
  WireModel wire(input, planner, weights);
  const PlanBasis basis{wire, planned_points(input, wire.layout), 1, {}};
  ReadPlan plan = proven(make_plans(basis, group_points(basis)), wire, basis.points);
  return PlanRunner(wire, basis.points, std::move(plan));
}

}  // namespace

Scheduler::Scheduler(const ScheduleInput& input, Planner planner, const CyclicWeights& weights)
    : runner_(first_runner(input, planner, weights)),
      load_(runner_.plan().load),
      grouped_for_(bridges_of(runner_.wire().layout)) {}

void Scheduler::acquired(const Block& block, Instant acquired) {
  const double before = runner_.overrun();
  runner_.acquired(block, acquired);
  stale_ = stale_ || runner_.overrun() != before;
}

void Scheduler::launched(const Block& block, Instant now) {
  const double before = runner_.overrun();
  runner_.launched(block, now);
  stale_ = stale_ || runner_.overrun() != before;
}

void Scheduler::set_response_time(DeviceIndex device, AreaIndex area, Duration response_time) {
  if (runner_.set_response_time(device, area, response_time)) stale_ = costs_changed_ = true;
}

void Scheduler::set_longest(DeviceIndex device, AreaIndex area, std::uint32_t items) {
  if (runner_.set_longest(device, area, items)) stale_ = costs_changed_ = true;
}

void Scheduler::set_point(PointIndex point, const Point& wanted, Instant now) {
  runner_.set_point(point, wanted, now);
  stale_ = true;
}

std::unique_ptr<PlanDraft> Scheduler::draft() {
  if (drafting_ || !stale_) return nullptr;
  auto draft = std::make_unique<PlanDraft>(runner_, grouped_for_, costs_changed_);
  stale_ = costs_changed_ = false;
  drafting_ = true;
  runner_.remember_changes();
  return draft;
}

void Scheduler::adopt(PlanDraft& draft, Instant now) {
  PlanDraft::Result made = draft.take_result();
  drafting_ = false;
  load_ = made.load;
  grouped_for_ = std::move(made.grouped_for);
  if (made.plan) runner_.adopt(*std::move(made.plan), made.began, now);
  runner_.forget_changes();
}

void replan(Scheduler& scheduler, Instant now) {
  const auto draft = scheduler.draft();
  if (!draft) return;
  draft->make();
  scheduler.adopt(*draft, now);
}

std::unique_ptr<Scheduler> make_scheduler(const ScheduleInput& input, Planner planner) {
  return std::make_unique<Scheduler>(input, planner);
}

}  // namespace fieldcast
