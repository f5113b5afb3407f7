// The factor of a value as register lists write it. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace fieldcast::importing {

struct Factor {
  double value = 1;
  std::string unit;  // "0.1 kWh" names it too
};

// What commas and dots mean in a column of numbers: one number alone may not tell it.
struct NumberStyle {
  bool decimal_comma = false;  // "0,1" or "2,75" stands somewhere
  bool decimal_point = false;
  void learn(std::string_view cell);
};

// "0.1", "x0.1", "1/10", "/10", "÷10", "*0,01", "10^-1", "10**-2", "10⁻³", "2^-7",
// "1 × 10^-2", "1 = 0.1", "0.1 V", "1:100". Nothing inside: there is none ("-", "none"). The
// error says why it is none.
[[nodiscard]] tl::expected<std::optional<Factor>, std::string> factor_from(std::string_view cell,
                                                                           NumberStyle style);

// Returns the scale in the cell of the unit, for example of "0.1 kW"; empty if there is no scale or
// if it is not a power of ten.
[[nodiscard]] std::optional<Factor> factor_of_unit(std::string_view unit, NumberStyle style);

// "Value weight: Volt*10" among remarks: the device has multiplied by it. Nothing: none stands
// there.
[[nodiscard]] std::optional<double> weight_from(std::string_view remark);

}  // namespace fieldcast::importing
