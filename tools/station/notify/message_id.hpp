// Texts that identify messages and alarms. Pure functions.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "core/alarm/alarm_status.hpp"

namespace fieldcast::web {

// 32 hexadecimal digits that depend only on the parts.
[[nodiscard]] std::string message_id(std::initializer_list<std::string_view> parts);

// Printable and at most 200 bytes, whatever a bridge has published.
[[nodiscard]] std::string shown(std::string_view name);

// "press-shop/press-1/level high", printable.
[[nodiscard]] std::string shown(const AlarmKey& alarm);

// "2026-11-29 06:00:00 +0100", by the time zone of the process.
[[nodiscard]] std::string local_time(UtcTime at);

// "raised, critical: press-shop/press-1/level high = 39, since 2026-11-29 06:00:00 +0100"
[[nodiscard]] std::string digest_line(std::string_view kind, const AlarmKey& alarm,
                                      const AlarmStatus& status);

}  // namespace fieldcast::web
