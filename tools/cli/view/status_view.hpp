// Buses and devices as tables and JSON lines. Pure: the newest status of each, to text.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bridge/station/station.hpp"
#include "tools/cli/view/json.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

struct StatusModel {
  std::map<std::string, StationBusStatus> buses;
  std::map<std::pair<std::string, std::string>, StationDeviceStatus> devices;  // by bus and name
};

// Two tables: buses with the use of their wire, devices with what they learned; counters of each
// cause beside them.
[[nodiscard]] std::vector<std::string> status_lines(const StatusModel& model, UtcTime now,
                                                    const Screen& screen);

// The fields of BusStatus and DeviceStatus by their IDL names, and "topic": which of the two it is.
// Times in nanoseconds.
[[nodiscard]] Json status_json(const StationBusStatus& status);
[[nodiscard]] Json status_json(const StationDeviceStatus& status);

}  // namespace fieldcast::cli
