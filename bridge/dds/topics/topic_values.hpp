// Content of the topics as plain values, without DDS types; any thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/alarm/alarm_status.hpp"
#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/model/channel_kind.hpp"
#include "core/model/channel_spec.hpp"
#include "core/model/command.hpp"
#include "core/model/status.hpp"
#include "core/plan/read_plan.hpp"

namespace fieldcast {

struct StationSample {
  std::string bus, device, channel;
  [[nodiscard]] std::string path() const { return bus + '/' + device + '/' + channel; }
  Value value;
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  UtcTime acquired_at;
  std::uint64_t sequence = 0;
  std::uint64_t epoch = 0;  // of the bus's catalogue; 0 for a sample of fieldcast/Sample
};

struct StationChannel {
  std::string bridge, bus, device, channel;
  [[nodiscard]] std::string path() const { return bus + '/' + device + '/' + channel; }
  std::string type;  // "float32", "string(16)"
  std::string unit, at, description;
  Access access = Access::kReadOnly;
  Mode mode = Mode::kScheduled;
  Duration refresh{};  // 0: no promise
  Limits limits;
  std::optional<double> write_min, write_max;
  friend bool operator==(const StationChannel&, const StationChannel&) = default;
};

// Only causes that occurred, by name: "CHECKSUM".
using CauseCounts = std::map<std::string, std::uint64_t>;

struct StationBusStatus {
  std::string bridge, bus;
  BusReport report;  // all but causes and misses
  CauseCounts causes;
  UtcTime reported_at;
  CauseCounts misses{};
  std::uint64_t dds_deadline_misses = 0;
  // By how much the clock of the machine that received it is ahead of the bridge's: clock_offsets.
  std::optional<Duration> clock_ahead{};
};
struct StationDeviceStatus {
  std::string bus, device;
  DeviceReport report;  // all but causes
  CauseCounts causes;
  UtcTime reported_at;
};

struct StationDeviceDescription {
  std::string bridge, bus, device;
  std::string protocol;  // "modbus-rtu"
  std::string port;      // "/dev/ttyUSB0 19200 8E1"
  std::string address;   // on the bus
  // By channel; only those with decimals, or with configured ones.
  std::map<std::string, ShownDigits, std::less<>> digits;
  friend bool operator==(const StationDeviceDescription&,
                         const StationDeviceDescription&) = default;
};

struct StationReadPlan {
  std::string bus;
  PlanReport plan;
  UtcTime in_force_since;
};

struct StationAlarm {
  std::string bus, device, channel;
  LimitKind limit = LimitKind::kHigh;
  AlarmState state = AlarmState::kClear;
  double value = 0;
  UtcTime since;
};

struct StationBridge {
  struct Bus {
    std::string bus;
    UtcTime since;         // when the bridge first claimed it
    bool serving = false;  // false: another bridge serves a bus of this name
  };
  std::string bridge, host, version;
  std::string process;        // distinguishes bridges on the same host
  std::string standby_group;  // group of bridges that stand by for each other; empty: none
  std::int32_t strength = 0;  // rank within the group
  UtcTime since;
  std::vector<Bus> buses;
};

struct StationAlarmStatus {
  AlarmKey alarm;
  AlarmStatus status;
};

// A command of a station. The station sets requester, expires, and request_id unless reserved.
struct StationCommand {
  std::string bus;
  Command command;
  // The bridge never starts the command later than this after it was written.
  Duration lifespan = std::chrono::seconds{5};
  // User who requests it from the station, for the audit of the bridge: 1 to 64 letters, digits,
  // '-', '_', '.', '@'. Empty: the process itself.
  std::string person{};
};
struct StationResult {
  std::string requester;
  std::uint64_t request_id = 0;
  std::string bus;
  CommandState state = CommandState::kFailed;
  std::string cause;  // "NONE", "READ_ONLY", ...
  std::uint16_t device_code = 0;
  std::string reason;
  std::vector<Value> values;
  UtcTime received_at, started_at, completed_at;
};
// A station's interest in channels, or its end.
struct Interest {
  std::string station;
  std::string pattern;              // bus/device/channel with *
  std::optional<Duration> refresh;  // `std::nullopt`: withdrawn, or the station crashed
};

}  // namespace fieldcast
