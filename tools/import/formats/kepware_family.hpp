// Converts addresses of Kepware drivers for other families than Modbus. Most notations are equal;
// these differ:
//
// s7-ppi           V100 with type Word is VW100; V100.3 stays; T37, C5 and HC0 are values
// omron-hostlink   TC005 is the value of a timer or counter, TS005 its flag; DM0100.20H a text
//
// Source: PTC, Kepware driver help, "S7-200 Addressing" and "C200H Addressing" (Omron Host Link),
// support.ptc.com. Pure.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "tools/import/points/model.hpp"

namespace fieldcast::importing {

// `type`: tag type in lower case, without " array"; `point` lacks only `at` and `type`. Appends one
// point for each element. The error is the reason; the validation checks unknown addresses.
[[nodiscard]] tl::expected<void, std::string> append_family_point(std::string_view protocol,
                                                                  std::string_view address,
                                                                  const std::string& type,
                                                                  const Point& point,
                                                                  std::vector<Point>& points);

}  // namespace fieldcast::importing
