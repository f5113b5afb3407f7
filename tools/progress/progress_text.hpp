// Formats progress and remaining time. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/time.hpp"

namespace fieldcast {

// "simulating line" and "42 %, 65s left"; a narrow terminal truncates the first.
struct ProgressText {
  std::string what;
  std::string how_far;
};

// `share`: finished share, 0 to 1. No estimate in the first tenth of a second.
[[nodiscard]] ProgressText progress_text(std::string_view what, double share, Duration elapsed);

// "120000 lines, 40000 each second", if the total is unknown.
[[nodiscard]] ProgressText progress_count_text(std::string_view what, std::uint64_t count,
                                               std::string_view unit, Duration elapsed);

// "what: how far" in at most `columns`. Shortens `what` first, then truncates `how_far`.
[[nodiscard]] std::string progress_line_text(const ProgressText& text, std::size_t columns);

}  // namespace fieldcast
