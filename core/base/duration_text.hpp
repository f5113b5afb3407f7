// Durations as people write them: "500us", "20ms", "1.5s", "30m" or "30min", "1h", "30d", "0s". The
// one grammar of configurations, fault files and command lines; to_text(Duration) in time.hpp is
// its printer. Pure functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/time.hpp"

namespace fieldcast {

// What a fault says is allowed.
inline constexpr std::string_view kDurationForm = "a number with us, ms, s, min, h or d";

// A decimal number, directly followed by its unit; nothing for anything else. What is longer than
// 200 years is 200 years, so that every limit refuses it.
[[nodiscard]] std::optional<Duration> duration_from(std::string_view text);

// Why a text is no duration within its bounds, in words.
struct DurationFault {
  std::string what;        // follows the text: "has no unit", "is too long"
  std::string allowed;     // "a number with us, ms, s, min, h or d, 1ms to 24h"
  std::string suggestion;  // what was probably meant; empty when nothing is near
};

// "'5 sec' is no duration; allowed: ...; did you mean 5s?"
[[nodiscard]] std::string fault_text(std::string_view text, const DurationFault& fault);

// Both bounds are allowed. A number without a unit is a fault, or seconds where a command line has
// always taken them so.
struct DurationBounds {
  Duration min, max;
  bool bare_seconds = false;
};
[[nodiscard]] tl::expected<Duration, DurationFault> read_duration(std::string_view text,
                                                                  const DurationBounds& bounds);

}  // namespace fieldcast
