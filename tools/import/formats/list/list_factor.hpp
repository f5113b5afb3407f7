// Parses the factor of a value in a register list. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace fieldcast::importing {

struct Factor {
  double value = 1;
  std::string unit;  // from the same cell: "0.1 kWh"
};

// Meaning of commas and dots in a column of numbers, learned from all cells.
struct NumberStyle {
  bool decimal_comma = false;  // "0,1" or "2,75" was found
  bool decimal_point = false;
  void learn(std::string_view cell);
};

// "0.1", "x0.1", "1/10", "/10", "÷10", "*0,01", "10^-1", "10**-2", "10⁻³", "2^-7", "1 × 10^-2", "1
// = 0.1", "0.1 V", "1:100". Contains no value for "-" or "none". The error is the reason.
[[nodiscard]] tl::expected<std::optional<Factor>, std::string> factor_from(std::string_view cell,
                                                                           NumberStyle style);

// Returns the scale in the unit's cell, for example of "0.1 kW"; empty if there is none or it is
// not a power of ten.
[[nodiscard]] std::optional<Factor> factor_of_unit(std::string_view unit, NumberStyle style);

// "Value weight: Volt*10" in a remark: the device has multiplied by it. Empty if there is none.
[[nodiscard]] std::optional<double> weight_from(std::string_view remark);

}  // namespace fieldcast::importing
