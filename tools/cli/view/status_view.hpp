// Buses and devices as tables and JSON lines. Pure: the newest status of each, to text.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bridge/station/station.hpp"
#include "core/base/json.hpp"
#include "tools/cli/view/status_facts.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// For each bus its facts in words, a table of its devices with bad ones first, and below it what is
// special about each. Texts are wrapped at the screen's width, or at 80 columns.
[[nodiscard]] std::vector<std::string> status_lines(const StatusModel& model, UtcTime now,
                                                    const Screen& screen);

// The fields of BusStatus and DeviceStatus by their IDL names, and "topic": which of the two it is.
// Times in nanoseconds.
[[nodiscard]] Json status_json(const StationBusStatus& status);
[[nodiscard]] Json status_json(const StationDeviceStatus& status);

}  // namespace fieldcast::cli
