// Converts `std.divide(10)` or `expr.evaluate("int32(R0, R1) / 100")` of mqmgateway to type and
// scale. Pure.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "tools/import/points/model.hpp"

namespace fieldcast::importing {

struct Converted {
  ValueType type = ValueType::kUint16;
  std::uint16_t string_bytes = 0;
  std::optional<std::uint8_t> bit, byte;
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder byte_order = ByteOrder::kBigEndian;
  double scale = 1, offset = 0;
  std::string change;  // difference from the list; empty: none
};

// REQUIRES: `count` registers, 1 to 125. The error names what is not supported.
[[nodiscard]] tl::expected<Converted, std::string> convert_mqm(std::string_view converter,
                                                               unsigned count);

// value = scale * X + offset, where X is one call such as `flt32(R0,R1)` or `R0`.
struct LinearForm {
  std::string function;    // "int32", "flt32bs", ..; empty: the register itself
  bool low_first = false;  // (R1, R0)
  double scale = 1, offset = 0;
};
// Empty if the expression is not of this form.
[[nodiscard]] std::optional<LinearForm> linear_form(std::string_view expression);

}  // namespace fieldcast::importing
