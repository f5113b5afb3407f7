// Formats the SunSpec models of a device as text, as JSON and as a comment. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/scan/sunspec_walk.hpp"

namespace fieldcast::cli {

// Only devices with Modbus can have SunSpec models.
[[nodiscard]] bool may_have_sunspec(std::string_view protocol);

// "SolarEdge, SE10K, 4.18, serial number 7F12"; the text is untrusted.
[[nodiscard]] std::string sunspec_identity(const SunSpecMap& map);

// "address 1: SunSpec models from holding:40000 on: 1 (common), 103 (..), 64001"; with the reason
// if the list is incomplete.
[[nodiscard]] std::vector<std::string> sunspec_lines(std::uint16_t address, const SunSpecMap& map);

// {"base", "manufacturer", "model", "version", "serial_number", "models": [{"number", "at",
// "length"}], "incomplete"}; incomplete is empty for a complete list.
[[nodiscard]] Json sunspec_json(const SunSpecMap& map);

// Comment lines for a device of a configuration: its models, and why the list is incomplete.
[[nodiscard]] std::string sunspec_comment(const SunSpecMap& map);

}  // namespace fieldcast::cli
