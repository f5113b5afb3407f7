// What a new configuration means for a bridge that runs: decided here, done by Bridge. Pure.
#pragma once

#include <string>
#include <vector>

#include "bridge/program/leased_device.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

struct ReloadPlan {
  // Why everything starts anew, one line for people each: the name, the DDS settings or the store
  // differ. Then the lists below are empty.
  std::vector<std::string> whole_bridge;
  bool program = false;            // the programming server starts anew; buses and modules go on
  bool metrics = false;            // their server starts anew, or ends
  std::vector<std::string> stop;   // buses that are gone or changed, in their old order
  std::vector<std::string> start;  // buses that are new or changed, in their new order
  std::vector<std::string> untouched;  // buses that keep running
  [[nodiscard]] bool nothing() const {
    return whole_bridge.empty() && !program && !metrics && stop.empty() && start.empty();
  }
};

// REQUIRES: names of buses are unique in each of the two.
[[nodiscard]] ReloadPlan plan_reload(const BridgeSpec& running, const BridgeSpec& wanted);

// The leased devices that the plan would take away from engineers: those of buses that stop or
// begin, and all when the programming server starts anew. The reload waits for them.
[[nodiscard]] std::vector<program::LeasedDevice> disturbed_by(
    const ReloadPlan& plan, const BridgeSpec& wanted,
    const std::vector<program::LeasedDevice>& leased);

}  // namespace fieldcast
