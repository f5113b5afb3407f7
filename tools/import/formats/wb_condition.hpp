// Evaluates conditions of wb-mqtt-serial templates. Pure.
//
// Source: wirenboard/wb-mqtt-serial src/expression_evaluator.cpp: comparisons with an unset
// parameter are false, `!=` is true.
#pragma once

#include <functional>
#include <optional>
#include <string_view>

namespace fieldcast::importing {

using ParameterValue = std::function<std::optional<double>(std::string_view name)>;

// Empty if the text is not a condition.
[[nodiscard]] std::optional<bool> condition_holds(std::string_view condition,
                                                  const ParameterValue& value_of);

}  // namespace fieldcast::importing
