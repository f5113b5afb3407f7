// Formats the status of buses and devices as tables and JSON lines. Pure.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bridge/station/station.hpp"
#include "tools/cli/view/json.hpp"
#include "tools/cli/view/status_facts.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// For each bus its facts, a table of its devices (bad ones first), and remarks below. Wraps at the
// screen's width, or at 80 columns.
[[nodiscard]] std::vector<std::string> status_lines(const StatusModel& model, UtcTime now,
                                                    const Screen& screen);

// The fields of BusStatus and DeviceStatus by their IDL names; "topic" names the type. Times in
// nanoseconds.
[[nodiscard]] Json status_json(const StationBusStatus& status);
[[nodiscard]] Json status_json(const StationDeviceStatus& status);

}  // namespace fieldcast::cli
