// The bodies of requests about alarms, from JSON. Pure; nothing in a body is trusted.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/alarm/alarm_status.hpp"
#include "tools/station/api/parameters.hpp"

namespace fieldcast::web {

// {"alarms": [{"bus", "device", "channel", "limit"}..], "note"}: one action for each alarm. With
// kShelve "minutes" too.
[[nodiscard]] Checked<std::vector<AlarmAction>> alarm_actions(AlarmActionKind kind,
                                                              const nlohmann::json& body);
// {"bus", "device", "minutes", "note"}; 0 minutes end the maintenance.
[[nodiscard]] Checked<AlarmAction> maintenance_action(const nlohmann::json& body);

}  // namespace fieldcast::web
