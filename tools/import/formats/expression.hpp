// Expressions in lists of other programs. Pure; they limit the depth and the length.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace fieldcast::importing {

// value = scale * X + offset, where X is one call such as `flt32(R0,R1)` or `R0`.
struct LinearForm {
  std::string function;    // "int32", "flt32bs", ..; empty: the register itself
  bool low_first = false;  // (R1, R0)
  double scale = 1, offset = 0;
};
// "R0 / 10", "(R0 - 320) * 0.05", "int32(R1, R0) / 1000": an expression of mqmgateway. Empty if the
// expression is not linear in one value.
[[nodiscard]] std::optional<LinearForm> linear_form(std::string_view expression);

using ParameterValue = std::function<std::optional<double>(std::string_view name)>;
// Evaluates a condition of wb-mqtt-serial templates. Comparisons with an unset parameter are false,
// `!=` is true. Empty if the text is not a condition.
//
// Source: wirenboard/wb-mqtt-serial src/expression_evaluator.cpp.
[[nodiscard]] std::optional<bool> condition_holds(std::string_view condition,
                                                  const ParameterValue& value_of);

}  // namespace fieldcast::importing
