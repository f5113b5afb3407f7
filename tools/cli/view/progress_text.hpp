// How far something is, and how much longer it takes, in words. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/time.hpp"

namespace fieldcast::cli {

// "simulating line: 42 %, 65s left". `share` is what is done of 1; until a tenth of a second has
// passed nothing is said of the rest.
[[nodiscard]] std::string progress_text(std::string_view what, double share, Duration elapsed);

// "history: 120000 lines, 40000 each second", where nobody knows how many there will be.
[[nodiscard]] std::string progress_count_text(std::string_view what, std::uint64_t count,
                                              std::string_view unit, Duration elapsed);

}  // namespace fieldcast::cli
