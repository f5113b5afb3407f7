// Sent once a second and at every state change.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/model/sample.hpp"

namespace fieldcast {

enum class BusState : std::uint8_t { kOpening, kRunning, kClosed, kLeased, kStopped };
enum class DeviceState : std::uint8_t { kUnknown, kOnline, kDegraded, kOffline };
[[nodiscard]] std::string_view to_text(BusState state);
[[nodiscard]] std::string_view to_text(DeviceState state);

struct BusReport {
  BusState state = BusState::kOpening;
  Cause closed_because = Cause::kNone;  // while closed
  // Share of the last second in which the wire was busy or had to be silent, 0..1.
  double utilisation = 0;
  double planned_load = 0;   // share required by the plan
  double measured_load = 0;  // share used by reads, over the last 10 s
  std::uint64_t exchanges = 0, samples = 0, commands = 0, deadline_misses = 0, bytes_sent = 0,
                bytes_received = 0, reopened = 0;
  double stretch = 1;  // factor on refreshes under overload
  Duration silence{};  // between a response and the next request: configured, or learned
  // `listening`: does not send (`fence: listen`). `foreign_masters`: heard while sending.
  bool listening = false;
  std::uint64_t foreign_masters = 0;
  CauseCounters causes;  // of failed exchanges
  CauseCounters misses;  // of missed refreshes; their sum is deadline_misses
};

// One channel since the start; for simulations and tests.
struct ChannelReport {
  std::uint64_t readings = 0, missed = 0;
  Duration worst_gap{};            // between two readings, or from the promise to the first one
  Cause last_miss = Cause::kNone;  // of the last missed refresh
};

struct AreaReport {
  std::string area;
  Duration response_time{}, response_spread{};
  std::uint32_t largest_block = 0;  // items read in one block so far
  // Known once a longer block was refused; 0 if none was refused.
  std::uint32_t longest_block = 0;
  friend bool operator==(const AreaReport&, const AreaReport&) = default;
};

struct DeviceReport {
  DeviceState state = DeviceState::kUnknown;
  std::uint64_t exchanges = 0, failures = 0, retries = 0, deadline_misses = 0;
  Duration response_time{};  // learned: end of request to first byte of the response
  Duration response_spread{};
  Duration timeout{};                // current one; at most the configured one
  Duration pause{};                  // after its responses: configured, or learned
  std::vector<AreaReport> areas;     // those that were read
  std::vector<std::string> refused;  // currently refused addresses, at most 64
  // Address ranges that no block may bridge, at most 64: "holding:105..107".
  std::vector<std::string> refused_gaps;
  CauseCounters causes;
};

enum class ProgramSessionState : std::uint8_t { kOpen, kClosed, kRefused };
[[nodiscard]] std::string_view to_text(ProgramSessionState state);  // "open", "closed", "refused"

struct ProgramSessionReport {
  std::string bus, device;  // a module without a bus: "dial-in" and its device number
  ProgramSessionState state = ProgramSessionState::kClosed;
  std::string who;
  std::uint64_t bytes_to_device = 0, bytes_from_device = 0;
  UtcTime since;
};

// The last request that the software of an engineer sent to a device.
struct ProgramRequestReport {
  std::string bus, device;
  std::string request;  // decoded
  UtcTime sent_at;
};

// What was written to a device, and by whom.
struct AuditReport {
  std::string bridge;
  std::uint64_t epoch = 0;   // of the bridge; greater after each restart
  std::uint64_t number = 0;  // in the epoch, from 1
  UtcTime at;
  std::string who, what, target;  // as in AuditEntry (bridge/store/records)
  std::uint64_t bytes_to_device = 0, bytes_from_device = 0;
  std::string result;  // one human-readable line
};

// Data that a bus continues from another bridge. Plain values.
struct BusInheritance {
  // By channel; sequence 0 if never published. `acquired` uses the clock of the new engine.
  std::vector<Sample> samples;
  std::map<std::string, DeviceReport> devices;  // by name; learned values
  // Sample numbers continue above it, for all channels.
  std::uint64_t above = 0;
};

}  // namespace fieldcast
