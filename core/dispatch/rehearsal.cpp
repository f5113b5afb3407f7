#include "core/dispatch/rehearsal.hpp"

#include <algorithm>

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
    const Instant answered = now + block.cost - runner.wire().tails[block.device];
    late += late_in(block, runner, answered);
    runner.acquired(block, answered);
    now += block.cost;
    ++reads;
  }
  return late;
}

}  // namespace fieldcast
