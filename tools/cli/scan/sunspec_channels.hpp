// Points of the common SunSpec models as channels of a configuration. Source:
// github.com/sunspec/models (json/model_N.json). Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

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

}  // namespace fieldcast::cli
