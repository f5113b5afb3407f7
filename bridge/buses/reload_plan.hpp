// Decides what a new configuration changes in a running bridge. The bridge carries it out. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridge/program/server.hpp"
#include "bridge/store/records/records.hpp"
#include "core/alarm/alarm_monitor.hpp"
#include "core/base/time.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

struct ReloadPlan {
  // Reasons for a full restart, one human-readable line each: the name, the DDS settings or the
  // store differ. If not empty, the lists below are empty.
  std::vector<std::string> whole_bridge;
  bool program = false;            // the programming server restarts; buses and modules continue
  bool metrics = false;            // the metrics server restarts or ends
  std::vector<std::string> stop;   // removed or changed buses, in their old order
  std::vector<std::string> start;  // new or changed buses, in their new order
  std::vector<std::string> untouched;
  [[nodiscard]] bool nothing() const {
    return whole_bridge.empty() && !program && !metrics && stop.empty() && start.empty();
  }
};

// REQUIRES: the bus names of each specification are unique.
[[nodiscard]] ReloadPlan plan_reload(const BridgeSpec& running, const BridgeSpec& wanted);

// "reloaded: 1 bus stopped (a), 1 started (b), 2 untouched"
[[nodiscard]] std::string to_text(const ReloadPlan& plan);

// The end of an alarm whose limit was removed; empty if the channel is not in `running`.
[[nodiscard]] std::optional<AlarmChange> end_of_alarm(const BridgeSpec& running,
                                                      const AlarmRecord& alarm, Instant now);

// Leased devices that the plan would take from engineers. The reload waits for them.
[[nodiscard]] std::vector<program::LeasedDevice> disturbed_by(
    const ReloadPlan& plan, const BridgeSpec& wanted,
    const std::vector<program::LeasedDevice>& leased);

}  // namespace fieldcast
