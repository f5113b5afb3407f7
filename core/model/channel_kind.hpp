// Kinds of channels: how one is read, who may write it, and its alarm limits. Plain values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/time.hpp"

namespace fieldcast {

inline constexpr std::size_t kMaxNameLength = 64;

enum class Mode : std::uint8_t {
  kIntensive,  // the bus never idles: the oldest channel is always next
  kScheduled,  // read in time for the refresh; the wire rests otherwise
  kOnDemand,   // only read by command
};
[[nodiscard]] std::string_view to_text(Mode mode);  // "intensive", "scheduled", "on-demand"

enum class Access : std::uint8_t { kReadOnly, kReadWrite, kWriteOnly };
[[nodiscard]] std::string_view to_text(Access access);  // "read-only", ...

// How soon an alarm needs action.
enum class AlarmPriority : std::uint8_t { kLow, kMedium, kHigh, kCritical };
[[nodiscard]] std::string_view to_text(AlarmPriority priority);  // "low", "medium", ...

struct Limits {
  std::optional<double> low_low, low, high, high_high;
  double hysteresis = 0;  // how far a value must be back inside to clear the alarm
  Duration delay{};       // how long it must be outside to raise the alarm
  // Empty: high for low-low and high-high, medium for the others.
  std::optional<AlarmPriority> priority{};
  friend bool operator==(const Limits&, const Limits&) = default;
};

}  // namespace fieldcast
