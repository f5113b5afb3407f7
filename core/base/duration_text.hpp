// Parses durations: "500us", "20ms", "1.5s", "30m" or "30min", "1h", "30d", "0s". The reverse is
// to_text(Duration) in time.hpp. Pure functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/time.hpp"

namespace fieldcast {

inline constexpr std::string_view kDurationForm = "a number with us, ms, s, min, h or d";

// A decimal number directly followed by its unit; empty for other texts. Values above 200 years
// become 200 years, so that every limit rejects them.
[[nodiscard]] std::optional<Duration> duration_from(std::string_view text);

struct DurationFault {
  std::string what;        // follows the text: "has no unit", "is too long"
  std::string allowed;     // "a number with us, ms, s, min, h or d, 1ms to 24h"
  std::string suggestion;  // empty if there is no similar duration
};

// One line with the allowed form and the suggestion.
[[nodiscard]] std::string fault_text(std::string_view text, const DurationFault& fault);

// Inclusive. `bare_seconds`: a number without a unit is accepted as seconds.
struct DurationBounds {
  Duration min, max;
  bool bare_seconds = false;
};
[[nodiscard]] tl::expected<Duration, DurationFault> read_duration(std::string_view text,
                                                                  const DurationBounds& bounds);

}  // namespace fieldcast
