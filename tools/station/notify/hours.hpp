// Hours of a rule in local time: "mon-fri 18:00-06:00", "sat-sun", "08:00-17:00". Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/time.hpp"

namespace fieldcast::web {

struct LocalMinute {
  int weekday = 0;  // 0: Monday
  int minute = 0;   // of the day by the wall clock, 0..1439
};
// By the time zone of the process (TZ or /etc/localtime).
[[nodiscard]] LocalMinute local_minute(UtcTime at);

struct HoursSpan {
  std::uint8_t days = 0x7f;    // bit 0: Monday; the day on which the span begins
  int from = 0, to = 24 * 60;  // minutes of the day; to <= from: until the next day

  [[nodiscard]] bool contains(const LocalMinute& at) const;
  friend bool operator==(const HoursSpan&, const HoursSpan&) = default;
};

// Days, times or both; empty if the text is invalid.
inline constexpr std::string_view kHoursForm = "mon-fri 18:00-06:00, sat-sun or 08:00-17:00";
[[nodiscard]] std::optional<HoursSpan> hours_from(std::string_view text);
// A text that hours_from() reads as the same span.
[[nodiscard]] std::string to_text(const HoursSpan& span);

// Returns true also if there are no spans.
[[nodiscard]] bool in_hours(std::span<const HoursSpan> spans, const LocalMinute& at);

}  // namespace fieldcast::web
