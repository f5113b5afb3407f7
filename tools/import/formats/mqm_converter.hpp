// Converts `std.divide(10)` or `expr.evaluate("int32(R0, R1) / 100")` of mqmgateway to type and
// scale. Pure.
#pragma once

#include <optional>
#include <string_view>

#include "tools/import/points/model.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

// Fills type, orders, scale and changes of the point, and `bit` for a bit of a register. Returns
// what is not supported. REQUIRES: `count` registers, 1 to 125.
[[nodiscard]] MayFail convert_mqm(std::string_view converter, unsigned count, Point& point,
                                  std::optional<std::uint8_t>& bit);

}  // namespace fieldcast::importing
