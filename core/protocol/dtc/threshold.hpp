#pragma once

#include <cstddef>

#include "core/base/time.hpp"
#include "core/frame/line.hpp"

namespace fieldcast::dtc {

// Longer than any message: disables compression.
inline constexpr std::size_t kNever = 65535;

// To compress and expand a message of n bytes costs n * per_byte, while the wire is idle. It saves
// half a character for each byte after the first sixteen, which fill the dictionary, minus the two
// length bytes. The threshold is the smallest n with no loss; kNever if the line is too fast.
// `per_byte` covers both ends.
[[nodiscard]] std::size_t auto_threshold(const LineFormat& line, Duration per_byte);

}  // namespace fieldcast::dtc
