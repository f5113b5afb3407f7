// Enumerators by their names in payloads. Pure.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/alarm/alarm_status.hpp"
#include "core/base/cause.hpp"
#include "core/model/channel_kind.hpp"

namespace fieldcast::forward {

inline constexpr std::array kAccesses{Access::kReadOnly, Access::kReadWrite, Access::kWriteOnly};
inline constexpr std::array kModes{Mode::kIntensive, Mode::kScheduled, Mode::kOnDemand};
inline constexpr std::array kPriorities{AlarmPriority::kLow, AlarmPriority::kMedium,
                                        AlarmPriority::kHigh, AlarmPriority::kCritical};
inline constexpr std::array kStages{AlarmStage::kClear, AlarmStage::kUnacknowledged,
                                    AlarmStage::kAcknowledged, AlarmStage::kReturned};
inline constexpr std::array kQualities{Quality::kGood,
                                       Quality::kUncertain,
                                       Quality::kBadNoResponse,
                                       Quality::kBadFrame,
                                       Quality::kBadDeviceError,
                                       Quality::kBadRange,
                                       Quality::kBadConfiguration,
                                       Quality::kNotYetRead};

// Empty if no enumerator has this name.
template <class Enum, std::size_t N>
[[nodiscard]] std::optional<Enum> enum_from(const std::array<Enum, N>& all, std::string_view text) {
  for (const Enum each : all) {
    if (to_text(each) == text) return each;
  }
  return std::nullopt;
}

}  // namespace fieldcast::forward
