// Alarms of one bus: compares the samples with the limits, updates the table of active alarms,
// writes the log, and returns each change for DDS. Called on the bus's thread.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bridge/publish/alarm_table.hpp"
#include "core/alarm/alarm_monitor.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class AlarmReporter {
 public:
  // The table outlives this object.
  AlarmReporter(AlarmTable& table, const BusSpec& bus);

  // Return the changes caused by these samples or by the time; usually none. Include alarms from
  // before the start of this bus that continue or have ended meanwhile.
  [[nodiscard]] std::vector<AlarmChange> on_samples(const std::vector<Sample>& samples,
                                                    const UtcMapping& mapping, Instant now);
  [[nodiscard]] std::vector<AlarmChange> on_time(const UtcMapping& now);  // once a second

 private:
  enum class Origin : std::uint8_t { kNew, kRestored };
  [[nodiscard]] std::vector<AlarmChange> restore();  // empty unless the table has changed
  void note(const std::vector<AlarmChange>& changes, const UtcMapping& mapping, Origin origin);

  AlarmTable& table_;
  AlarmMonitor monitor_;
  const std::string bus_;
  std::vector<std::pair<std::string, std::string>> names_;  // device and channel, by channel index
  std::uint64_t restored_ = 0;
};

}  // namespace fieldcast
