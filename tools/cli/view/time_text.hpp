// Points in time as people write them. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/time.hpp"

namespace fieldcast::cli {

// "2026-11-21", "2026-11-21T10:30", "2026-11-21 10:30:05.25", each UTC with or without a Z; "2h",
// "30min", "1d": so long ago; "now". The fault is a line for people.
[[nodiscard]] tl::expected<UtcTime, std::string> parse_time(std::string_view text, UtcTime now);

}  // namespace fieldcast::cli
