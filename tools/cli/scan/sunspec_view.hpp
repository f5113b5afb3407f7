// Points of the common SunSpec models as channels of a configuration. Source:
// github.com/sunspec/models (json/model_N.json). Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/scan/sunspec_walk.hpp"

namespace fieldcast::cli {

// "inverter, three phases"; empty if the tables do not have the model.
[[nodiscard]] std::string_view sunspec_model_name(std::uint16_t number);

// One line in YAML's short form for each point of the models with a table:
// { name: inverter-ac-power, at: "holding:40083", type: int16, .. }
// A point that is not whole inside its model is left out, and so are inputs of model 160 from the
// seventh on. Names begin with the kind of the model,
// and with its count from the second one of a kind on: meter-2-current.
[[nodiscard]] std::vector<std::string> sunspec_channels(const SunSpecMap& map);

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
