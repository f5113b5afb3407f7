// How far something is, and how much longer it takes, in words. Pure functions; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/time.hpp"

namespace fieldcast {

// "simulating line" and "42 %, 65s left": on a narrow terminal the first one gives way.
struct ProgressText {
  std::string what;
  std::string how_far;
};

// `share` is what is done of 1; until a tenth of a second has passed nothing is said of the rest.
[[nodiscard]] ProgressText progress_text(std::string_view what, double share, Duration elapsed);

// "120000 lines, 40000 each second", where nobody knows how many there will be.
[[nodiscard]] ProgressText progress_count_text(std::string_view what, std::uint64_t count,
                                               std::string_view unit, Duration elapsed);

// On one line of at most so many columns: "what: how far". Where that is too long, `what` is
// shortened, and left out where less than four columns are left for it; then `how_far` is cut.
[[nodiscard]] std::string progress_line_text(const ProgressText& text, std::size_t columns);

}  // namespace fieldcast
