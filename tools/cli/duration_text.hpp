// Durations as the command line takes them.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/time.hpp"

namespace fieldcast::cli {

// "500ms", "2s", "1.5min", "1h", "200us", or plain seconds: "20". Above zero and below a year; the fault is a line for people.
[[nodiscard]] tl::expected<Duration, std::string> parse_duration(std::string_view text);

}  // namespace fieldcast::cli
