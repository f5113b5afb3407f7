// Plain values; the states are those of ANSI/ISA-18.2 (alarm_life.hpp).
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/alarm/limit_watch.hpp"
#include "core/base/time.hpp"
#include "core/model/channel_kind.hpp"

namespace fieldcast {

struct AlarmKey {
  std::string bus, device, channel;
  LimitKind limit = LimitKind::kHigh;
  friend auto operator<=>(const AlarmKey&, const AlarmKey&) = default;
};
[[nodiscard]] std::string to_text(const AlarmKey& key);  // "press-shop/press-1/level high"

enum class AlarmStage : std::uint8_t {
  kClear,           // the limit is not exceeded
  kUnacknowledged,  // exceeded, not acknowledged
  kAcknowledged,    // exceeded, acknowledged
  kReturned,        // no longer exceeded, not acknowledged
};
[[nodiscard]] std::string_view to_text(AlarmStage stage);  // "clear", "unacknowledged", ...

// Acknowledgement; at == 0 if there is none.
struct AlarmNote {
  std::string by, note;
  UtcTime at;
  friend bool operator==(const AlarmNote&, const AlarmNote&) = default;
};

// A temporary suspension of an alarm; until == 0 if there is none.
struct AlarmPause {
  std::string by, note;
  UtcTime since, until;
  [[nodiscard]] bool is_set() const { return until.nanoseconds != 0; }
  friend bool operator==(const AlarmPause&, const AlarmPause&) = default;
};

struct AlarmStatus {
  AlarmPriority priority = AlarmPriority::kMedium;
  AlarmStage stage = AlarmStage::kClear;
  bool active = false;            // the limit is exceeded
  double value = 0;               // value that raised or cleared it
  UtcTime raised_at;              // present or last occurrence; 0 if unknown
  UtcTime cleared_at;             // 0 while active
  std::uint32_t occurrences = 0;  // in the last 10 minutes
  bool chattering = false;
  AlarmNote acknowledged;  // of the present or last occurrence
  AlarmPause shelved;
  AlarmPause suppressed;  // its device is in maintenance
  [[nodiscard]] UtcTime since() const { return active ? raised_at : cleared_at; }
  friend bool operator==(const AlarmStatus&, const AlarmStatus&) = default;
};

enum class AlarmActionKind : std::uint8_t {
  kAcknowledge,
  kShelve,
  kUnshelve,
  kMaintenance,  // of a device: suppresses its alarms
  kEndMaintenance,
};
[[nodiscard]] std::string_view to_text(AlarmActionKind kind);  // "acknowledge", ...
[[nodiscard]] constexpr bool is_of_device(AlarmActionKind kind) {
  return kind == AlarmActionKind::kMaintenance || kind == AlarmActionKind::kEndMaintenance;
}

struct AlarmAction {
  std::string requester;  // key with request_id: one result for each pair
  std::uint64_t request_id = 0;
  std::string subject{};  // authenticated by DDS Security; empty without it
  AlarmActionKind kind = AlarmActionKind::kAcknowledge;
  AlarmKey alarm;        // for maintenance: bus and device
  std::string by, note;  // operator, and a note in one line
  Duration duration{};   // kShelve, kMaintenance: from its arrival
  UtcTime raised_at;     // kAcknowledge: the occurrence shown to the operator; 0: any
};

}  // namespace fieldcast
