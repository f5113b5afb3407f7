#include "core/dispatch/headroom.hpp"

#include <algorithm>

namespace fieldcast {
namespace {

constexpr int kMostAhead = 64;
constexpr Duration kHorizon = std::chrono::seconds{1};
// Part of an allowed gap that is kept for unplanned delays. The timetable has no reserve for
// intensive points: among scheduled ones, a small delay may cost them a whole read.
constexpr double kReserve = 0.03, kIntensiveReserve = 0.15;

bool in_time(const Block& block, const PlanRunner& runner, Instant acquired) {
  return std::ranges::all_of(block.points, [&](PointIndex index) {
    const PointState& point = runner.point(index);
    const double reserve = point.mode == Mode::kIntensive ? kIntensiveReserve : kReserve;
    // A point that failed, or was not read yet, has no promise to keep.
    return point.eager || later(acquired, part_of(reserve, point.allowed_gap)) <= point.deadline;
  });
}

}  // namespace

bool has_headroom(PlanRunner runner, Instant now, Duration use) {
  now = later(now, use);
  const Instant end = later(now, kHorizon);
  for (int reads = 0; reads < kMostAhead && now < end;) {
    const Decision decision = runner.next(now);
    if (const auto* rest = std::get_if<Rest>(&decision)) {
      now = std::max(later(now, Duration{1}), rest->until);
      continue;
    }
    const Block& block = std::get<Block>(decision);
    const Instant acquired = now + block.cost - runner.wire().tails[block.device];
    if (!in_time(block, runner, acquired)) return false;
    runner.acquired(block, acquired);
    now = later(now, block.cost);
    ++reads;
  }
  return true;
}

}  // namespace fieldcast
