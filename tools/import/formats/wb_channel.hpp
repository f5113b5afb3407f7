// Converts an entry of wb-mqtt-serial `channels` to a point. Pure.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "tools/import/points/model.hpp"
#include "tools/import/text/tree.hpp"

namespace fieldcast::importing {

struct WbBase {
  std::uint32_t shift = 0;   // registers
  std::uint32_t stride = 0;  // multiplied by the registers of each value
};

// `point` has its name and origin. Returns the reason if it cannot be imported.
[[nodiscard]] std::optional<std::string> read_wb_channel(const Node& channel, const WbBase& base,
                                                         Point& point);

// Evaluates conditions of wb-mqtt-serial templates. Pure.
//
// Source: wirenboard/wb-mqtt-serial src/expression_evaluator.cpp: comparisons with an unset
// parameter are false, `!=` is true.

using ParameterValue = std::function<std::optional<double>(std::string_view name)>;

// Empty if the text is not a condition.
[[nodiscard]] std::optional<bool> condition_holds(std::string_view condition,
                                                  const ParameterValue& value_of);

}  // namespace fieldcast::importing
