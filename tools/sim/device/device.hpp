// The interface between a simulated PLC family and the rest of the simulator.
//
// A SimDevice owns the memory of one PLC and outlives its receivers. A Receiver is that device
// listening on one line: on a serial bus each device has one, on TCP each connection has one.
// Receivers get every character of the line, also the requests to others and their answers, as a
// real slave does. Pure: characters and instants in, answers out; no clock, no thread, no I/O.
// Everything runs on the simulator's one thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/frame/line.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::sim {

// What a device did, for the report and for tests.
struct DeviceStatistics {
  // Addressed to it and executed or refused, by function: "03".
  std::map<std::string, std::uint64_t> requests;
  std::map<unsigned, std::uint64_t> exceptions;  // by code
  // By item: "holding:107"; one for each write request that touched it.
  std::map<std::string, std::uint64_t> writes;
  std::uint64_t write_requests = 0;  // executed ones
  std::uint64_t broadcasts = 0;      // executed without an answer
  std::uint64_t bad_frames = 0;      // received: checksum, length or characters wrong
  std::uint64_t answers = 0;         // made; faults may still take them away
};

// What a device does about a character or a silence.
struct Reaction {
  Bytes answer;  // empty: it stays silent
  // More than the device's usual time before the answer, as the request asked for.
  Duration pause{};
  bool hang_up = false;  // the stream cannot be followed any more (TCP): the connection is closed
};

class Receiver {
 public:
  virtual ~Receiver() = default;
  // One more character; its last stop bit ended at `end`. Instants never go back.
  virtual void on_character(std::uint8_t character, Instant end, Reaction& reaction) = 0;
  // The instant at which an unbroken silence would mean something; kNever: it would not.
  [[nodiscard]] virtual Instant silence_due() const { return kNever; }
  // The line was silent until `now`, at or after silence_due().
  virtual void on_silence([[maybe_unused]] Instant now, [[maybe_unused]] Reaction& reaction) {}
};

class SimDevice {
 public:
  virtual ~SimDevice() = default;
  // REQUIRES: the device outlives the receiver.
  [[nodiscard]] virtual std::unique_ptr<Receiver> open_receiver() = 0;
  [[nodiscard]] virtual const DeviceStatistics& statistics() const = 0;
  // An item of its memory, right-aligned, past the wire; nothing for an area or item that it does
  // not have. A poked item holds like a written one.
  [[nodiscard]] virtual std::optional<std::uint64_t> peek([[maybe_unused]] std::string_view area,
                                                          [[maybe_unused]] std::uint32_t item,
                                                          [[maybe_unused]] Instant now) {
    return std::nullopt;
  }
  virtual bool poke([[maybe_unused]] std::string_view area, [[maybe_unused]] std::uint32_t item,
                    [[maybe_unused]] std::uint64_t bits) {
    return false;
  }
};

// Addresses that the device refuses with a code of its protocol.
struct RefusedRange {
  std::string area;                // as the protocol's DeviceKind names it
  std::uint32_t from = 0, to = 0;  // both included
  std::uint8_t code = 2;
};

// Everything a device is made of.
struct DeviceSetup {
  DeviceSpec spec;
  LineFormat line;
  bool stream = false;        // reached over TCP: the pieces of a frame may come apart
  bool first_on_bus = false;  // answers for the bus itself (unit 0 and 255 on Modbus TCP)
  std::vector<RefusedRange> refused;
  bool only_configured = false;  // addresses that no channel names do not exist
  std::uint64_t seed = 1;        // of its waveforms
  Instant start{};               // of the plant: waveforms begin here
};

// One row for each protocol that can be simulated.
struct DeviceKind {
  std::string_view protocol;                // as in the configuration: "modbus-rtu"
  std::span<const std::string_view> areas;  // names for RefusedRange
  bool half_duplex = true;  // one sends at a time; sending into another garbles both
  // The device, or what it cannot understand in its specification.
  tl::expected<std::unique_ptr<SimDevice>, std::string> (*make)(const DeviceSetup& setup) = nullptr;
};
[[nodiscard]] std::span<const DeviceKind> device_kinds();
[[nodiscard]] const DeviceKind* find_device_kind(std::string_view protocol);
// That of the device's protocol, built in or declared; nullptr where there is none.
[[nodiscard]] const DeviceKind* kind_of(const DeviceSpec& device);
[[nodiscard]] std::vector<std::string_view> area_names(const DeviceSpec& device);

}  // namespace fieldcast::sim
