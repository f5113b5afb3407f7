// Parses and formats points in time. Local times depend on the process's time zone.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/time.hpp"

namespace fieldcast::cli {

// "2026-11-21", "2026-11-21T10:30", "2026-11-21 10:30:05.25" in UTC or with an offset such as
// +01:00; "2h", "30min", "1d" before now; "now". The error is one human-readable line.
[[nodiscard]] tl::expected<UtcTime, std::string> parse_time(std::string_view text, UtcTime now);

enum class Zone : unsigned char { kUtc, kLocal };
// "2026-11-21T03:04:05.678Z", or "2026-11-21T04:04:05.678+01:00"; "-" if unset.
[[nodiscard]] std::string time_text(UtcTime time, Zone zone);

}  // namespace fieldcast::cli
