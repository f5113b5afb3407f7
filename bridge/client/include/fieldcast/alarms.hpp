/// @file
/// Alarms of channels, with the states of ANSI/ISA-18.2. Plain values; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "fieldcast/values.hpp"

namespace fieldcast::api {
inline namespace v1 {

enum class Limit : std::uint8_t { kLowLow, kLow, kHigh, kHighHigh };
[[nodiscard]] std::string_view to_text(Limit limit);  ///< "low-low", ...

enum class Priority : std::uint8_t { kLow, kMedium, kHigh, kCritical };
[[nodiscard]] std::string_view to_text(Priority priority);  ///< "low", ...

enum class AlarmStage : std::uint8_t {
  kClear,
  kUnacknowledged,  ///< the value is beyond the limit, and nobody has acknowledged
  kAcknowledged,    ///< the value is beyond the limit
  kReturned,        ///< the value is back inside, and nobody has acknowledged
};
[[nodiscard]] std::string_view to_text(AlarmStage stage);  ///< "clear", ...

struct Alarm {
  Path path;
  Limit limit = Limit::kHigh;
  Priority priority = Priority::kMedium;
  AlarmStage stage = AlarmStage::kClear;
  double value = 0;             ///< that raised or cleared the alarm
  Time raised_at, cleared_at;   ///< the last occurrence; cleared_at is the epoch while it is active
  std::uint32_t occurrences{};  ///< in the last 10 minutes
  std::string acknowledged_by, note;
  bool shelved = false, suppressed = false;
  bool present = true;  ///< false: the bridge has left the domain
};

}  // namespace v1
}  // namespace fieldcast::api
