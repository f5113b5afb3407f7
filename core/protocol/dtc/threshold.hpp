// From which length on a message is worth compressing: the cost model of the wire, with the time
// that both ends compute. Pure.
#pragma once

#include <cstddef>

#include "core/base/time.hpp"
#include "core/frame/line.hpp"

namespace fieldcast::dtc {

// Longer than any message: nothing is ever compressed.
inline constexpr std::size_t kNever = 65535;

// A message of n bytes costs n * per_byte to compress and to expand again, while nothing is sent;
// it saves half a character of the wire for each byte behind the first sixteen, in which the
// dictionary learns, less the two length bytes. The threshold is the n at which that balance is no
// longer negative; `per_byte` counts both ends. kNever where the line is too fast for it.
[[nodiscard]] std::size_t auto_threshold(const LineFormat& line, Duration per_byte);

}  // namespace fieldcast::dtc
