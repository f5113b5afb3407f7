#include "core/schedule/planned_times.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {
namespace {

constexpr Duration kStep = std::chrono::microseconds{250};

// A plan with a response time that is too short runs late; one that is too long wastes time.
bool differs(Duration planned, Duration usual) {
  if (usual > planned) return usual - planned > std::max(kStep, planned / 16);
  return planned - usual >= std::max(2 * kStep, planned / 8);
}

}  // namespace

PlannedTimes::PlannedTimes(std::span<const std::size_t> areas, Duration assumed) {
  for (const std::size_t count : areas) entries_.emplace_back(count, Entry{{}, assumed, 0});
}

Duration PlannedTimes::rounded(Duration response_time) {
  constexpr int kMostSteps = 32;
  const Duration time = std::max(response_time, Duration::zero());
  Duration step = kStep;
  while (time >= kMostSteps * step) step *= 2;
  return (time + step * 3 / 4) / step * step;  // rounds up rather than down
}

std::vector<PlannedTime> PlannedTimes::responded(DeviceIndex device, AreaIndex area,
                                                 Duration measured) {
  std::vector<PlannedTime> changes;
  Entry& entry = entries_[device][area];
  const bool first = entry.responses == 0;
  entry.responses = std::min(entry.responses + 1, kUsualResponses);
  entry.usual += (std::max(measured, Duration::zero()) - entry.usual) / entry.responses;
  if (differs(entry.planned, entry.usual)) plan_for(device, area, rounded(entry.usual), changes);
  if (!first) return changes;
  for (DeviceIndex other = 0; other < entries_.size(); ++other) plan_for_unknown(other, changes);
  return changes;
}

void PlannedTimes::responded(DeviceIndex device, AreaIndex area, Duration measured,
                             Scheduler& scheduler) {
  for (const PlannedTime& each : responded(device, area, measured))
    scheduler.set_response_time(each.device, each.area, each.response_time - saved_);
}

void PlannedTimes::save(Duration silence, Scheduler& scheduler) {
  if (silence == std::exchange(saved_, silence)) return;
  for (DeviceIndex device = 0; device < entries_.size(); ++device) {
    for (AreaIndex area = 0; area < entries_[device].size(); ++area)
      scheduler.set_response_time(device, area, entries_[device][area].planned - saved_);
  }
}

void PlannedTimes::plan_for_unknown(DeviceIndex device, std::vector<PlannedTime>& changes) {
  const auto slowest = [](std::span<const Entry> areas) {
    Duration most{-1};
    for (const Entry& entry : areas) {
      if (entry.responses > 0) most = std::max(most, entry.planned);
    }
    return most;
  };
  Duration most = slowest(entries_[device]);
  if (most < Duration::zero()) {
    for (const auto& others : entries_) most = std::max(most, slowest(others));
  }
  for (AreaIndex area = 0; area < entries_[device].size(); ++area) {
    if (entries_[device][area].responses == 0) plan_for(device, area, most, changes);
  }
}

void PlannedTimes::plan_for(DeviceIndex device, AreaIndex area, Duration planned,
                            std::vector<PlannedTime>& changes) {
  Entry& entry = entries_[device][area];
  if (entry.planned == planned) return;
  entry.planned = planned;
  changes.push_back({device, area, planned});
}

void PlannedTimes::forget(DeviceIndex device) {
  for (Entry& entry : entries_[device]) entry.responses = 0;
}

}  // namespace fieldcast
