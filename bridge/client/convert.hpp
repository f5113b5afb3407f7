// Conversion between the values of the library's public headers and those of the tree. Pure.
#pragma once

#include "bridge/station/station.hpp"
#include "fieldcast/alarms.hpp"
#include "fieldcast/commands.hpp"
#include "fieldcast/settings.hpp"
#include "fieldcast/status.hpp"
#include "fieldcast/values.hpp"

namespace fieldcast::api {

[[nodiscard]] Time to_public(UtcTime time);
[[nodiscard]] UtcTime to_inner(Time time);
[[nodiscard]] DdsSite to_inner(const Domain& domain);
[[nodiscard]] Sample to_public(const StationSample& sample);
[[nodiscard]] Channel to_public(const StationChannel& channel);
[[nodiscard]] Alarm to_public(const StationAlarmStatus& status);
[[nodiscard]] BusStatus to_public(const StationBusStatus& status);
[[nodiscard]] DeviceStatus to_public(const StationDeviceStatus& status);
[[nodiscard]] Bridge to_public(const StationBridge& bridge);
[[nodiscard]] Result to_public(const StationOutcome& outcome);
[[nodiscard]] AlarmKey key_of(const Alarm& alarm);

}  // namespace fieldcast::api
