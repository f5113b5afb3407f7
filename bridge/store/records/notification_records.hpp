// Rows of the notifications of a station. Plain values.
#pragma once

#include <cstdint>
#include <string>

#include "core/alarm/alarm_status.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

// What a rule has sent about one occurrence of an alarm.
struct NotifyProgress {
  enum class State : std::uint8_t { kOpen, kAcknowledged, kClosed };
  enum class Return : std::uint8_t { kNone, kSeen, kReported };
  std::string rule;
  AlarmKey alarm;
  State state = State::kOpen;
  UtcTime occurrence;         // when the alarm was raised; part of the id of each message
  UtcTime first_at, last_at;  // of the messages about its start; last_at 0: repeat immediately
  std::uint32_t count = 0;    // of these messages
  std::uint32_t escalated = 0;
  Return returned = Return::kNone;
  friend bool operator==(const NotifyProgress&, const NotifyProgress&) = default;
};

// Messages of a rule to a target in the present window. Further ones are collected for a digest.
struct NotifyWindow {
  std::string rule, target;
  UtcTime start;  // 0: the row is removed
  std::uint32_t count = 0;
  std::string lines;       // of the digest, each with a line end
  std::uint32_t more = 0;  // alarms beyond the lines
  friend bool operator==(const NotifyWindow&, const NotifyWindow&) = default;
};

// One message for one recipient.
struct Notification {
  std::string id;  // the same after a restart; in Message-ID and in the JSON
  std::string target, recipient;
  UtcTime made_at;
  std::string subject, text;                // of a mail
  std::string json;                         // of a webhook
  std::string attachment_name, attachment;  // of a mail; base64 in one line
  friend bool operator==(const Notification&, const Notification&) = default;
};

struct QueuedNotification : Notification {
  std::string state = "waiting";  // "sent", "expired", "dropped"
  std::uint32_t attempts = 0;
  UtcTime next_at, done_at;
  std::string error;  // of the last attempt; one line
};

}  // namespace fieldcast
