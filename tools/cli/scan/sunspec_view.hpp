// The SunSpec models of a device for people, as JSON, and as a comment in a configuration.
// Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/scan/sunspec_walk.hpp"

namespace fieldcast::cli {

// Whether devices of this protocol can have SunSpec models: those of Modbus.
[[nodiscard]] bool may_have_sunspec(std::string_view protocol);

// "SolarEdge, SE10K, 4.18, serial number 7F12": as the device sent it.
[[nodiscard]] std::string sunspec_identity(const SunSpecMap& map);

// "address 1: SunSpec models from holding:40000 on: 1 (common), 103 (..), 64001"; the reason if the
// list is not whole.
[[nodiscard]] std::vector<std::string> sunspec_lines(std::uint16_t address, const SunSpecMap& map);

// {"base", "manufacturer", "model", "version", "serial_number", "models": [{"number", "at",
// "length"}], "incomplete"}; incomplete is empty if the list is whole.
[[nodiscard]] Json sunspec_json(const SunSpecMap& map);

// Comment lines for a device of a configuration: its models, and why the list is not whole.
[[nodiscard]] std::string sunspec_comment(const SunSpecMap& map);

}  // namespace fieldcast::cli
