// Encodes reports as JSON for /live and /api, with IDL names in snake_case, times in Unix
// milliseconds (`.._ms`, null if unset) and durations in milliseconds. Pure functions.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

[[nodiscard]] std::string bus_json(const StationBusStatus& bus);
// `about`: of the same device, or null.
[[nodiscard]] std::string device_json(const StationDeviceStatus& device,
                                      const StationDeviceDescription* about = nullptr);
// {"bus", "device", "bridge", "protocol", "port", "address", "digits": {channel: n}, "resolution":
// {channel: n}}: configured decimals, and those from the resolution of the channel.
[[nodiscard]] std::string description_json(const StationDeviceDescription& about);
[[nodiscard]] std::string interest_json(const Interest& interest);
[[nodiscard]] std::string alarm_json(const LiveAlarm& alarm);
[[nodiscard]] std::string session_json(const LiveSession& live);
[[nodiscard]] std::string bridge_json(const StationBridge& bridge);
[[nodiscard]] std::string site_json(const LiveSite& site);
[[nodiscard]] std::string stream_json(const LiveStream& stream);
// {"bus", "in_force_since_ms", "load", "stretch", "slot_ms", "hyperperiod_ms", "groups":
// [{"device", "list", "period_ms", "phase_ms", "slack_ms", "load", "points": [{"area", "first",
// "count", "channels": [names], "period_ms", "phase_ms", "worst_gap_ms", "stretch"}]}]}. Slot and
// hyperperiod are null without a timetable, as are times of entries outside it.
[[nodiscard]] std::string read_plan_json(const StationReadPlan& plan);
// For scripts: {"channel", "type", "unit", "access", "refresh_ms", "value", "quality",
// "acquired_ms", "sequence"}, "device_code" if the device sent one, and "digits" if `about` has the
// decimals of the channel. The value is null if it was never acquired.
[[nodiscard]] std::string channel_json(const LiveChannel& channel,
                                       const StationDeviceDescription* about = nullptr);
[[nodiscard]] std::string names_json(
    std::initializer_list<std::pair<std::string_view, std::string_view>> names);

[[nodiscard]] std::string kind_message(std::string_view kind, const std::string& object);

// Changes of the catalogue since that version: {"version", "full", "channels": [[id, path, type,
// unit, at, access, mode, refresh_ms, {"high": ..}, description, bridge]..], "gone": [ids]}.
[[nodiscard]] std::string catalogue_json(const LiveModel& model, std::uint64_t after);

}  // namespace fieldcast::web
