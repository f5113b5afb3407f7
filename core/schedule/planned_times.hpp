// The answer times on which the plan of a bus stands: learned, and told to its scheduler only when
// they make a difference.
//
// The bus engine and the prediction feed one each with the same answers, so that both plan alike.
// Values are rounded: answers that scatter by microseconds shall not lead to different plans. What
// has not answered yet is taken to be like what has. Plain value.
#pragma once

#include <span>
#include <vector>

#include "core/base/time.hpp"
#include "core/dispatch/scheduler.hpp"

namespace fieldcast {

// A plan shall take this for the answer time of reads of an area.
struct PlannedTime {
  DeviceIndex device = 0;
  AreaIndex area = 0;
  Duration answer_time{};
  friend bool operator==(const PlannedTime&, const PlannedTime&) = default;
};

class PlannedTimes {
 public:
  PlannedTimes() = default;
  // `areas`: how many areas each device has. `assumed`: what the scheduler was made with.
  PlannedTimes(std::span<const std::size_t> areas, Duration assumed);

  // A read of the area was answered `measured` after the end of its request. Returns what makes a
  // difference to plans: mostly nothing.
  [[nodiscard]] std::vector<PlannedTime> answered(DeviceIndex device, AreaIndex area,
                                                  Duration measured);
  // The same, told to the scheduler.
  void answered(DeviceIndex device, AreaIndex area, Duration measured, Scheduler& scheduler);
  // Another device may be there now.
  void forget(DeviceIndex device);

  // What a plan takes for an answer time: in steps of 0.25 ms, above 8 ms of 1/32 to 1/16.
  [[nodiscard]] static Duration rounded(Duration answer_time);

 private:
  static constexpr int kUsualAnswers = 64;  // answers that the usual time is the mean of
  struct Entry {
    Duration usual{};    // a slower mean than that of timeouts: plans shall seldom change
    Duration planned{};  // as the scheduler was last told
    int answers = 0;     // in the usual one
  };
  void plan_for(DeviceIndex device, AreaIndex area, Duration planned,
                std::vector<PlannedTime>& changes);
  void plan_for_unknown(DeviceIndex device, std::vector<PlannedTime>& changes);

  std::vector<std::vector<Entry>> entries_;  // by device and area
};

}  // namespace fieldcast
