// POST /api/commands, /api/alarms/acknowledge, shelve, unshelve and maintenance. The response has
// the request's id; the result follows on /live and by GET /api/commands/result. Runs on the io
// thread.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/alarm/alarm_status.hpp"
#include "tools/station/api/base/exchange.hpp"
#include "tools/station/live/client_message.hpp"
#include "tools/station/model/live_model.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

inline constexpr std::size_t kMaxAlarmsAtOnce = 200;  // in one request
inline constexpr std::uint32_t kMaxShelvedMinutes = 24 * 60;
inline constexpr std::uint32_t kMaxMaintenanceMinutes = 7 * 24 * 60;

// `model` and `commands` must outlive the table.
void add_command_routes(RouteTable& table, const LiveModel& model, CommandSink& commands);

// Parses the JSON bodies of alarm requests. Pure.

// Body: {"alarms": [{"bus", "device", "channel", "limit"}..], "note"}, for kShelve "minutes".
[[nodiscard]] Checked<std::vector<AlarmAction>> alarm_actions(AlarmActionKind kind,
                                                              const nlohmann::json& body);
// Body: {"bus", "device", "minutes", "note"}. 0 minutes end the maintenance.
[[nodiscard]] Checked<AlarmAction> maintenance_action(const nlohmann::json& body);

}  // namespace fieldcast::web
