// Who has the wire next: a command, a probe of an offline device, or a read; else the wire rests.
//
// Owns the order between them, and until when the wire rests. Owned by the bus engine, on the bus's
// thread; borrows the parts that it asks. Nothing can fail. Rules:
//   - An exchange that is to be repeated goes first.
//   - A command goes before reads; after it a read that is due goes before the next command.
//     Neither starves the other.
//   - A command that has begun keeps the wire while its device rests, unless that takes long.
//   - Probes, and reads of sick devices, take time that the wire can spare.
#pragma once

#include <optional>

#include "core/bus/bus_parts.hpp"

namespace fieldcast {

class Arbiter {
 public:
  // The wire rests no longer than this for a command that has begun.
  static constexpr Duration kLongestWait = std::chrono::milliseconds{20};
  // A scheduler that rests until now must not make the timer spin.
  static constexpr Duration kShortestRest = std::chrono::microseconds{100};

  explicit Arbiter(BusParts& parts);  // parts outlive the arbiter
  Arbiter(const Arbiter&) = delete;
  Arbiter& operator=(const Arbiter&) = delete;

  // Starts the next exchange and returns its first request; nothing while the wire must be silent,
  // or rests. REQUIRES: no exchange is on the wire.
  [[nodiscard]] std::optional<Bytes> next(Instant now);
  // Starts a short read that keeps the wire from being silent for long (WireFence), and returns its
  // request; nothing: no device can be asked now, or, unless it is `due`, a read would be late
  // for it. REQUIRES: next() had nothing, and the wire is free.
  [[nodiscard]] std::optional<Bytes> sign(Instant now, bool due);
  // When next() has something to do again, unless something happens before.
  [[nodiscard]] Instant look_again() const { return std::max(wire_.free_at(), rest_until_); }

  // Tells the scheduler how long the device is left alone.
  void suspend(DeviceIndex device, Instant now);

 private:
  // The next flight; nothing: the wire rests until rest_until_.
  [[nodiscard]] std::optional<Flight> choose(Instant now);
  [[nodiscard]] std::optional<Flight> choose_command(Instant now);
  [[nodiscard]] std::optional<Flight> choose_probe(Instant now);
  [[nodiscard]] std::optional<Flight> choose_read(Instant now);
  [[nodiscard]] Instant admit_deferred(Instant now);
  [[nodiscard]] Instant sendable_from(const CommandJob& job) const;
  [[nodiscard]] Bytes send(Instant now);

  CommandQueue& commands_;
  ReadPath& reads_;
  DeviceMonitor& devices_;
  LateAnswers& late_;
  Wire& wire_;
  CommandQueue::Gate command_gate_;
  bool command_was_last_ = false;
  Instant rest_until_ = kLongAgo;
};

}  // namespace fieldcast
