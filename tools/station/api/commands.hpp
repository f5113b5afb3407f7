// Parses the JSON bodies of alarm requests. Pure.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/alarm/alarm_status.hpp"
#include "tools/station/api/base/exchange.hpp"

namespace fieldcast::web {

inline constexpr std::size_t kMaxAlarmsAtOnce = 200;  // in one request
inline constexpr std::uint32_t kMaxShelvedMinutes = 24 * 60;
inline constexpr std::uint32_t kMaxMaintenanceMinutes = 7 * 24 * 60;

// Body: {"alarms": [{"bus", "device", "channel", "limit"}..], "note"}, for kShelve "minutes".
[[nodiscard]] Checked<std::vector<AlarmAction>> alarm_actions(AlarmActionKind kind,
                                                              const nlohmann::json& body);
// Body: {"bus", "device", "minutes", "note"}. 0 minutes end the maintenance.
[[nodiscard]] Checked<AlarmAction> maintenance_action(const nlohmann::json& body);
[[nodiscard]] Checked<AlarmAction> end_of_session(const nlohmann::json& body);

}  // namespace fieldcast::web
