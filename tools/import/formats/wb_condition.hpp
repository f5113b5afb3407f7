// Conditions of wb-mqtt-serial's templates: whether a channel exists, by the device's parameters.
// Pure.
//
// Source: wirenboard/wb-mqtt-serial src/expression_evaluator.cpp: comparisons with a parameter that
// is not set are false, `!=` is true.
#pragma once

#include <functional>
#include <optional>
#include <string_view>

namespace fieldcast::importing {

using ParameterValue = std::function<std::optional<double>(std::string_view name)>;

// Nothing if the text is no condition.
[[nodiscard]] std::optional<bool> condition_holds(std::string_view condition,
                                                  const ParameterValue& value_of);

}  // namespace fieldcast::importing
