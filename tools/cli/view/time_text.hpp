// Points in time as people write and read them. Functions of their arguments; local times also of
// the time zone of the process.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/time.hpp"

namespace fieldcast::cli {

// "2026-11-21", "2026-11-21T10:30", "2026-11-21 10:30:05.25", each UTC with or without a Z, or with
// an offset such as +01:00 behind the time of day; "2h", "30min", "1d": so long ago; "now". The
// fault is a line for people.
[[nodiscard]] tl::expected<UtcTime, std::string> parse_time(std::string_view text, UtcTime now);

enum class Zone : unsigned char { kUtc, kLocal };
// "2026-11-21T03:04:05.678Z", or "2026-11-21T04:04:05.678+01:00"; "-" for no such time.
[[nodiscard]] std::string time_text(UtcTime time, Zone zone);

}  // namespace fieldcast::cli
