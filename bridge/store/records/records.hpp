// Rows of the store. Plain values; names and texts as in the topics.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/alarm/alarm_registry.hpp"
#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

// An audit entry: a login, a command, or a transmission to a device.
struct AuditEntry {
  UtcTime at;
  // The user or the requester of a command, with the peer's address if known.
  std::string who;
  std::string what;    // "login", "write", "acquire", "program"
  std::string target;  // "press-shop/press-1/running"; empty: the bridge itself
  // Only of a transmission: several commands may be in one frame.
  std::uint64_t bytes_to_device = 0;
  std::uint64_t bytes_from_device = 0;
  std::string result;  // "done", "refused: wrong password"; one human-readable line
  friend bool operator==(const AuditEntry&, const AuditEntry&) = default;
};

// A sample of the history. A stale value is published again with its old time of acquisition.
struct StoredSample {
  std::string bus, device, channel, unit;
  std::string type;  // "float32"; empty if an older Fieldcast stored it
  UtcTime published_at;
  UtcTime acquired_at;  // 0: never read
  std::uint64_t sequence = 0;
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  Value value;
  friend bool operator==(const StoredSample&, const StoredSample&) = default;
};

// A bus began to publish with this epoch of its catalogue.
struct BusEpoch {
  std::string bus;
  std::uint64_t epoch = 0;
  friend bool operator==(const BusEpoch&, const BusEpoch&) = default;
};

struct DeviceRecord {
  std::string bus, device, protocol;
  std::string address;  // "/dev/ttyUSB0 19200 8E1, 7"
  std::string state;    // "online"
  UtcTime since;
  friend bool operator==(const DeviceRecord&, const DeviceRecord&) = default;
};

// A limit was exceeded or is met again.
struct AlarmRecord {
  std::string bus, device, channel;
  std::string limit;  // "high-high"
  std::string state;  // "active", "clear"
  double value = 0;
  UtcTime since;
  friend bool operator==(const AlarmRecord&, const AlarmRecord&) = default;
};

// An entry of the alarm history: a limit exceeded or met, an action, or an expired time.
struct AlarmLogEntry {
  std::string bus, device;
  std::string channel, limit;   // empty: all alarms of the device
  std::string event;            // "raised", "cleared", or a text of to_text(AlarmEventKind)
  std::optional<double> value;  // of "raised" and "cleared"
  std::string who, note;
  UtcTime at;
  UtcTime until;  // only of an event with an end
  friend bool operator==(const AlarmLogEntry&, const AlarmLogEntry&) = default;
};

// Receives the begin and end of alarms, and actions of users on alarms.
class AlarmSink {
 public:
  virtual ~AlarmSink() = default;
  // Any thread; never blocks, never fails.
  virtual void put(AlarmRecord alarm) = 0;
  virtual void put(KeptAlarm alarm) = 0;
  virtual void put(KeptMaintenance maintenance) = 0;
  virtual void put(AlarmEvent event) = 0;
};

// Records every transmission, command and login.
class Audit {
 public:
  virtual ~Audit() = default;
  // Any thread; never blocks, never fails. If the queue is full, the complete entry is written to
  // the log instead. An entry without a time (at == 0) gets the present one.
  virtual void append(AuditEntry entry) = 0;
};

}  // namespace fieldcast
