// What is known of one alarm, and what a person asks for. Plain values; the states are those of
// ANSI/ISA-18.2 (alarm_life.hpp).
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/alarm/limit_watch.hpp"
#include "core/base/time.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

// One limit of one channel.
struct AlarmKey {
  std::string bus, device, channel;
  LimitKind limit = LimitKind::kHigh;
  friend auto operator<=>(const AlarmKey&, const AlarmKey&) = default;
};
[[nodiscard]] std::string to_text(const AlarmKey& key);  // "press-shop/press-1/level high"

enum class AlarmStage : std::uint8_t {
  kClear,           // the limit is kept
  kUnacknowledged,  // it is passed, and nobody has acknowledged that
  kAcknowledged,    // it is passed, and somebody has
  kReturned,        // it is kept again, and nobody has acknowledged that it was passed
};
[[nodiscard]] std::string_view to_text(AlarmStage stage);  // "clear", "unacknowledged", ...

// Somebody acknowledged. at == 0: nobody did.
struct AlarmNote {
  std::string by, note;
  UtcTime at;
  friend bool operator==(const AlarmNote&, const AlarmNote&) = default;
};

// An alarm is put aside until its end. until == 0: it is not.
struct AlarmPause {
  std::string by, note;
  UtcTime since, until;
  [[nodiscard]] bool is_set() const { return until.nanoseconds != 0; }
  friend bool operator==(const AlarmPause&, const AlarmPause&) = default;
};

struct AlarmStatus {
  AlarmPriority priority = AlarmPriority::kMedium;
  AlarmStage stage = AlarmStage::kClear;
  bool active = false;            // the limit is passed
  double value = 0;               // that raised or cleared it
  UtcTime raised_at;              // the present occurrence, or the last one; 0: none is known
  UtcTime cleared_at;             // 0 while it is active
  std::uint32_t occurrences = 0;  // in the last 10 minutes
  bool chattering = false;
  AlarmNote acknowledged;  // of the present or last occurrence
  AlarmPause shelved;
  AlarmPause suppressed;  // its device is in maintenance
  // Since when the limit is passed, or kept again.
  [[nodiscard]] UtcTime since() const { return active ? raised_at : cleared_at; }
  friend bool operator==(const AlarmStatus&, const AlarmStatus&) = default;
};

enum class AlarmActionKind : std::uint8_t {
  kAcknowledge,
  kShelve,
  kUnshelve,
  kMaintenance,  // of a device: its alarms are suppressed
  kEndMaintenance,
};
[[nodiscard]] std::string_view to_text(AlarmActionKind kind);  // "acknowledge", ...
[[nodiscard]] constexpr bool is_of_device(AlarmActionKind kind) {
  return kind == AlarmActionKind::kMaintenance || kind == AlarmActionKind::kEndMaintenance;
}

struct AlarmAction {
  std::string requester;  // with request_id the key: one result for each pair
  std::uint64_t request_id = 0;
  std::string subject{};  // who asked, by DDS Security; empty without it
  AlarmActionKind kind = AlarmActionKind::kAcknowledge;
  AlarmKey alarm;        // of maintenance: bus and device
  std::string by, note;  // the person, and one line of theirs
  Duration duration{};   // kShelve, kMaintenance: how long from its arrival
  UtcTime raised_at;     // kAcknowledge: which occurrence the person saw; 0: any
};

}  // namespace fieldcast
