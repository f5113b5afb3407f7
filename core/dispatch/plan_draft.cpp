#include "core/dispatch/plan_draft.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace fieldcast {

namespace {

constexpr std::uint64_t kMostReads = 20'000;

// Keeps a reserve for unforeseen delays: half of the lead, up to a limit.
Instant latest_for(const PointState& point, Duration lead) {
  constexpr Duration kUnforeseen = std::chrono::milliseconds{1};
  const Duration own = std::min(lead, point.refresh / 10);
  return later(point.deadline, own - std::min(own / 2, kUnforeseen));
}

std::uint64_t late_in(const Block& block, const PlanRunner& runner, Instant acquired) {
  std::uint64_t late = 0;
  for (const PointIndex index : block.points) {
    const PointState& point = runner.point(index);
    // The plan does not cause a failed read.
    const bool failed = point.eager && point.retry_at != Instant{};
    if (point.mode == Mode::kScheduled && !failed &&
        acquired > latest_for(point, runner.wire().lead))
      ++late;
  }
  return late;
}

Duration round_of(const PlanRunner& runner) {
  Duration longest = runner.plan().hyperperiod();
  for (const PointState& point : runner.points()) {
    if (point.wanted() && point.mode == Mode::kScheduled)
      longest = std::max(longest, point.allowed_gap);
  }
  return longest;
}

}  // namespace

std::uint64_t count_late(PlanRunner runner, Instant now, std::uint64_t enough) {
  const Instant end = later(now, 2 * round_of(runner));
  std::uint64_t late = 0, reads = 0;
  runner.forget_paces(now);
  while (now < end && reads < kMostReads && late < enough) {
    const Decision decision = runner.next(now);
    if (const auto* rest = std::get_if<Rest>(&decision)) {
      now = std::max(now + Duration{1}, rest->until);
      continue;
    }
    const Block& block = std::get<Block>(decision);
    const Instant responded = now + block.cost - runner.wire().tails[block.device];
    late += late_in(block, runner, responded);
    runner.acquired(block, responded);
    now += block.cost;
    ++reads;
  }
  return late;
}

PlanDraft::PlanDraft(PlanRunner runner, std::vector<std::uint32_t> grouped_for, bool costs_changed)
    : runner_(std::move(runner)), costs_changed_(costs_changed) {
  result_.grouped_for = std::move(grouped_for);
  runner_.forget_changes();
}

// Keeps the present plan unless it must be replaced or another is proven better.
void PlanDraft::make() {
  PlanBasis basis = runner_.basis();
  const ReadPlan& present = runner_.plan();
  std::vector<ReadPlan> plans = plans_asked_for(basis);
  result_.began = runner_.last_seen();
  if (!present.table || (!plans.empty() && plans.front().stretch > 1)) {
    if (!plans.empty()) result_.plan = std::move(plans.front());
    return;
  }
  if (plans.empty() && present.stretch > 1) return;
  const bool must_go =
      !plans.empty() && (present.stretch > 1 || present.fastest != plans.front().fastest);
  std::uint64_t late = kAnyNumber;
  if (!must_go) late = count_late(runner_, runner_.last_seen() + runner_.wire().silence);
  if (plans.empty()) {
    if (late == 0) return;
    basis.periods.clear();
    Grouping grouping = group_points(basis);
    plans = make_plans(std::move(basis), std::move(grouping));
    result_.load = plans.front().load;
    if (plans.front().stretch > 1) return;
  }
  prove(plans, late);
}

// Empty if the difference is small.
std::vector<ReadPlan> PlanDraft::plans_asked_for(PlanBasis& basis) {
  const ReadPlan& present = runner_.plan();
  if (costs_changed_ && worth_grouping()) {
    basis.periods.clear();
    Grouping grouping = group_points(basis);
    if (grouping != present.grouping) {
      auto plans = make_plans(basis, std::move(grouping));
      result_.load = plans.front().load;
      return plans;
    }
  }
  result_.load = load_of(basis, present);
  if (!worth_planning(result_.load * basis.overrun, fastest_of(basis.points, basis.wire.lead)))
    return {};
  auto plans = make_plans(basis, present.grouping);
  result_.load = plans.front().load;
  return plans;
}

// A new timetable costs one round of reads.
bool PlanDraft::worth_planning(double demand, Duration fastest) const {
  constexpr double kMore = 1.02, kLess = 0.95;
  const ReadPlan& present = runner_.plan();
  const bool more = demand > kFullLoad && demand > kMore * present.demand;
  const bool ends = present.demand > kFullLoad && demand <= kFullLoad;
  const bool less = ends || (present.stretch > 1 && demand < kLess * present.demand);
  return fastest != present.fastest || more || less;
}

// Other groups move all phases, which costs one round of reads.
bool PlanDraft::worth_grouping() {
  constexpr double kMuch = 0.3;
  if (runner_.wire().rules.grouping == GroupingRule::kSinglePoints) return false;
  std::vector<std::uint32_t> bridges = bridges_of(runner_.wire().layout);
  bool much = bridges.empty();
  for (std::size_t i = 0; i < bridges.size(); ++i) {
    const double before = result_.grouped_for[i], now = bridges[i];
    much = much || std::abs(now - before) > kMuch * std::max(1.0, before);
  }
  if (much) result_.grouped_for = std::move(bridges);
  return much;
}

// The first plan whose rehearsal keeps every refresh; otherwise the one that breaks the fewest, if
// fewer than the present plan. Its table starts with the present one, or now.
void PlanDraft::prove(const std::vector<ReadPlan>& plans, std::uint64_t late_at_present) {
  const Instant seen = runner_.last_seen(), free = seen + runner_.wire().silence;
  const std::array<Instant, 2> starts{runner_.table_began(), seen};
  std::uint64_t least = late_at_present == 0 ? 1 : late_at_present;
  for (const ReadPlan& plan : plans) {
    for (const Instant start : starts) {
      PlanRunner trial = runner_;
      trial.adopt(plan, start, seen);
      const std::uint64_t late = count_late(std::move(trial), free, least);
      if (late >= least) continue;
      least = late;
      result_.began = start;
      result_.plan = plan;
      if (late == 0) return;
    }
  }
}

}  // namespace fieldcast
