// One limit of one channel: raised if good values stay beyond it for the delay, cleared if a good
// value is back inside by the hysteresis. Pure.
//
//   clear --beyond--> waiting --beyond for the delay--> active --inside by the hysteresis--> clear
//            ^-----------inside--------'
//
// A value that is not good neither raises nor clears. While the newest value is not good, a delay
// continues, but only the next good value can end it.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/time.hpp"
#include "core/model/channel_kind.hpp"

namespace fieldcast {

enum class LimitKind : std::uint8_t { kLowLow, kLow, kHigh, kHighHigh };
[[nodiscard]] std::string_view to_text(LimitKind kind);  // "low-low", ...
[[nodiscard]] std::optional<LimitKind> limit_kind_from(std::string_view text);

enum class AlarmState : std::uint8_t { kClear, kActive };
[[nodiscard]] std::string_view to_text(AlarmState state);  // "clear", "active"

class LimitWatch {
 public:
  LimitWatch(LimitKind kind, double limit, double hysteresis, Duration delay)
      : kind_(kind), limit_(limit), hysteresis_(hysteresis), delay_(delay) {}

  // Each returns true if the state changed; then state(), value() and since() are updated.
  [[nodiscard]] bool on_good(double value, Instant acquired, Instant now);  // NaN is not good
  void on_bad() { trusted_ = false; }
  [[nodiscard]] bool on_time(Instant now);
  // The alarm continues, or ends at the newest good value if that is back inside.
  void restore(double value, Instant since);

  [[nodiscard]] LimitKind kind() const { return kind_; }
  [[nodiscard]] AlarmState state() const { return state_; }
  [[nodiscard]] double value() const { return value_; }
  // Acquisition time of the first value beyond the limit, or back inside.
  [[nodiscard]] Instant since() const { return since_; }
  [[nodiscard]] bool waiting() const { return beyond_since_ && state_ == AlarmState::kClear; }

 private:
  [[nodiscard]] bool beyond(double value) const;
  [[nodiscard]] bool back_inside(double value) const;
  [[nodiscard]] bool raise_if_due(Instant now);

  LimitKind kind_;
  double limit_;
  double hysteresis_;
  Duration delay_;
  AlarmState state_ = AlarmState::kClear;
  std::optional<Instant> beyond_since_;
  bool trusted_ = false;  // the newest value is good
  double value_ = 0;
  Instant since_{};
  std::optional<double> newest_;  // the newest good value
  Instant newest_at_{};           // its acquisition time
};

// Plain values; the states are those of ANSI/ISA-18.2 (alarm_life.hpp).
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
  // Neither exceeded, nor unacknowledged, shelved or suppressed.
  [[nodiscard]] bool is_normal() const {
    return stage == AlarmStage::kClear && !active && !shelved.is_set() && !suppressed.is_set();
  }
  friend bool operator==(const AlarmStatus&, const AlarmStatus&) = default;
};

enum class AlarmActionKind : std::uint8_t {
  kAcknowledge,
  kShelve,
  kUnshelve,
  kMaintenance,  // of a device: suppresses its alarms
  kEndMaintenance,
  kEndSession,  // of a device: takes it back from the engineer who programs it
};
[[nodiscard]] std::string_view to_text(AlarmActionKind kind);  // "acknowledge", ...
[[nodiscard]] constexpr bool is_of_device(AlarmActionKind kind) {
  return kind >= AlarmActionKind::kMaintenance;
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
