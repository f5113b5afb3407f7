#include "core/plan/group_load.hpp"

#include <algorithm>

#include "core/plan/cycle.hpp"

namespace fieldcast {

void GroupLoad::imagine(std::span<const PlannedPoint> points, bool stretched) {
  imagined_.clear();
  for (const PlannedPoint& planned : points) {
    PointState& point = imagined_.emplace_back(PointState{planned});
    const double refresh = ns(point.refresh) * (stretched ? point.stretch : 1.0);
    point.allowed_gap = allowed_gap_of(refresh, wire_.lead);
    point.due = point.deadline = Instant{point.allowed_gap};
  }
}

std::uint32_t GroupLoad::most_urgent() const {
  std::uint32_t urgent = 0;
  for (std::uint32_t i = 0; i < imagined_.size(); ++i) {
    const bool sooner = !imagined_[urgent].wanted() || imagined_[i].due < imagined_[urgent].due;
    if (imagined_[i].wanted() && sooner) urgent = i;
  }
  return urgent;
}

double GroupLoad::of(const Group& group, std::span<const PlannedPoint> points, const Terms& terms) {
  constexpr int kReads = 64;
  imagine(points, terms.stretched);
  Duration longest{}, shortest = Duration::max();
  for (const PointState& point : imagined_) {
    if (!point.wanted()) continue;
    longest = std::max(longest, point.allowed_gap);
    shortest = std::min(shortest, point.allowed_gap);
  }
  if (longest == Duration::zero()) return 0;
  Cycle cycle;
  if (wire_.rules.timetable) cycle.period = cycle_period(shortest, terms.fastest, terms.margin);
  Instant now{};
  Duration spent{};
  for (int reads = 0; reads < kReads && now <= Instant{2 * longest}; ++reads) {
    const std::uint32_t urgent = most_urgent();
    now = imagined_[urgent].due;
    const Selection& read = selector_.select(wire_.layout, group, imagined_, urgent, now,
                                             {Duration::zero(), terms.period});
    spent += read.cost;
    for (const std::uint32_t i : read.members)
      imagined_[i].due = due_after(cycle, now, imagined_[i].allowed_gap);
  }
  return ns(spent) / ns(now.time_since_epoch());
}

}  // namespace fieldcast
