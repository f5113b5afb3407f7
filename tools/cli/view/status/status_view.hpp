#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bridge/station/station.hpp"
#include "core/base/json.hpp"
#include "tools/cli/text/text_table.hpp"
#include "tools/cli/view/status/status_facts.hpp"

namespace fieldcast::cli {

// Facts of each bus, its devices as a table (bad ones first), and remarks. Wraps at the screen's
// width, or at 80 columns.
[[nodiscard]] std::vector<std::string> status_lines(const StatusModel& model, UtcTime now,
                                                    const Screen& screen);

// IDL field names, and "topic" with the type. Times in nanoseconds.
[[nodiscard]] Json status_json(const StationBusStatus& status);
[[nodiscard]] Json status_json(const StationDeviceStatus& status);

}  // namespace fieldcast::cli
