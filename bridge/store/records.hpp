// What the store keeps, row by row. Plain values; names and texts as the topics have them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/alarm/alarm_book.hpp"
#include "core/base/quality.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

// Who did what, when, and what became of it: a login, a command, a transmission to a device.
struct AuditEntry {
  UtcTime at;
  // The user, or the requester of a command; with the peer's address where there is one.
  std::string who;
  std::string what;    // "login", "write", "acquire", "program"
  std::string target;  // "press-shop/press-1/running"; empty: the bridge itself
  // Of a transmission. A command's are not counted: several may travel in one frame.
  std::uint64_t bytes_to_device = 0;
  std::uint64_t bytes_from_device = 0;
  std::string result;  // "done", "refused: wrong password"; one line for people
  friend bool operator==(const AuditEntry&, const AuditEntry&) = default;
};

// A sample of the history. Published and acquired differ for a stale value, which is published
// again with its old instant.
struct StoredSample {
  std::string bus, device, channel, unit;
  std::string type;  // "float32"; empty: an older Fieldcast stored it
  UtcTime published_at;
  UtcTime acquired_at;  // 0: never read
  std::uint64_t sequence = 0;
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  Value value;
  friend bool operator==(const StoredSample&, const StoredSample&) = default;
};

// The newest state of a device.
struct DeviceRecord {
  std::string bus, device, protocol;
  std::string address;  // "/dev/ttyUSB0 19200 8E1, 7"
  std::string state;    // "online"
  UtcTime since;
  friend bool operator==(const DeviceRecord&, const DeviceRecord&) = default;
};

// A limit was passed, or is kept again.
struct AlarmRecord {
  std::string bus, device, channel;
  std::string limit;  // "high-high"
  std::string state;  // "active", "clear"
  double value = 0;
  UtcTime since;
  friend bool operator==(const AlarmRecord&, const AlarmRecord&) = default;
};

// A line of the history of alarms: a limit was passed or kept again, somebody did something about
// it, or time did.
struct AlarmLogEntry {
  std::string bus, device;
  std::string channel, limit;   // empty: all alarms of the device
  std::string event;            // "raised", "cleared", or as to_text(AlarmEventKind) says
  std::optional<double> value;  // of "raised" and "cleared"
  std::string who, note;
  UtcTime at;
  UtcTime until;  // of what has an end
  friend bool operator==(const AlarmLogEntry&, const AlarmLogEntry&) = default;
};

}  // namespace fieldcast
