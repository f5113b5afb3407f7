// Response times used by the plan of a bus, by engine and prediction alike. Learned values are
// passed to the scheduler only if they make a difference, and rounded, as small variations must not
// change plans. Unknown times are assumed to equal known ones. Plain value.
#pragma once

#include <span>
#include <vector>

#include "core/base/time.hpp"
#include "core/dispatch/scheduler.hpp"

namespace fieldcast {

struct PlannedTime {
  DeviceIndex device = 0;
  AreaIndex area = 0;
  Duration response_time{};
  friend bool operator==(const PlannedTime&, const PlannedTime&) = default;
};

class PlannedTimes {
 public:
  PlannedTimes() = default;
  PlannedTimes(std::span<const std::size_t> areas, Duration assumed);

  // Returns the changes relevant to plans, usually none.
  [[nodiscard]] std::vector<PlannedTime> responded(DeviceIndex device, AreaIndex area,
                                                   Duration measured);
  void responded(DeviceIndex device, AreaIndex area, Duration measured, Scheduler& scheduler);
  // By how much the learned silence of the wire is shorter than that of the plan. For the plan it
  // shortens each response time, which may become negative.
  void save(Duration silence, Scheduler& scheduler);
  // The device may have been replaced.
  void forget(DeviceIndex device);

  // Rounds to steps of 0.25 ms, above 8 ms of 1/32 to 1/16.
  [[nodiscard]] static Duration rounded(Duration response_time);

 private:
  static constexpr int kUsualResponses = 64;  // responses averaged in the usual time
  struct Entry {
    Duration usual{};    // a slower mean than for timeouts, so that plans rarely change
    Duration planned{};  // last value passed to the scheduler
    int responses = 0;   // counted in `usual`
  };
  void plan_for(DeviceIndex device, AreaIndex area, Duration planned,
                std::vector<PlannedTime>& changes);
  void plan_for_unknown(DeviceIndex device, std::vector<PlannedTime>& changes);

  std::vector<std::vector<Entry>> entries_;  // by device and area
  Duration saved_{};                         // by a learned silence
};

}  // namespace fieldcast
