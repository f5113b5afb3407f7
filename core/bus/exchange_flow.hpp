// Selects the next use of the wire: a command, a probe of an offline device, or a read. Owned by
// the bus engine, on the bus's thread; borrows the other parts. Rules:
//   - A repeated exchange is sent first.
//   - A command precedes reads; after it, a due read precedes the next command, so neither starves.
//     The same holds between the requests of a command that reads.
//   - A started write keeps the wire during its device's pause, unless the pause is long.
//   - A read in spare time is sent if a rehearsal shows that the next reads of the plan are in time
//     after it. A read of the gateway is also sent if the gateway has used less than its share.
//   - Probes, and reads of unhealthy devices, use spare time of the wire.
#pragma once

#include <optional>
#include <vector>

#include "core/bus/bus_parts.hpp"
#include "core/bus/setup/bus_setup.hpp"

namespace fieldcast {

class Arbiter {
 public:
  static constexpr Duration kLongestWait = std::chrono::milliseconds{20};
  // Keeps the timer from spinning when the scheduler rests until the present.
  static constexpr Duration kShortestRest = std::chrono::microseconds{100};

  explicit Arbiter(BusParts& parts);  // `parts` must outlive the arbiter
  Arbiter(const Arbiter&) = delete;
  Arbiter& operator=(const Arbiter&) = delete;

  // Starts the next exchange; empty while the wire must rest. REQUIRES: no exchange is on the wire.
  [[nodiscard]] std::optional<Bytes> next(Instant now);
  // Starts a short read that limits the silence of the wire (WireFence) and returns its request.
  // Empty if no device can be polled now, or if the read would delay a second read and is not
  // `due`. REQUIRES: next() returned empty, and the wire is free.
  [[nodiscard]] std::optional<Bytes> sign(Instant now, bool due);
  // When next() may return a request, unless an event occurs before.
  [[nodiscard]] Instant look_again() const {
    return std::max(parts_.wire().free_at(), rest_until_);
  }

  void suspend(DeviceIndex device, Instant now);

 private:
  [[nodiscard]] std::optional<Flight> choose(Instant now);
  [[nodiscard]] std::optional<Flight> choose_command(Instant now);
  [[nodiscard]] std::optional<Flight> choose_probe(Instant now);
  [[nodiscard]] std::optional<Flight> choose_read(Instant now);
  [[nodiscard]] Instant admit_deferred(Instant now);
  [[nodiscard]] Instant sendable_from(const CommandJob& job);
  // When a read in spare time may be sent. kNever: not before the next exchange has ended, as the
  // headroom only shrinks until then.
  [[nodiscard]] Instant spare_from(const CommandJob& job);
  [[nodiscard]] Duration wire_use(DeviceIndex device, const Request& request) const;
  [[nodiscard]] Bytes send(Instant now);

  BusParts& parts_;
  CommandQueue& commands_;
  ReadPath& reads_;
  DeviceMonitor& devices_;
  LateResponseFilter& late_;
  const double gateway_share_;
  CommandQueue::Gate command_gate_;
  bool command_was_last_ = false;
  Instant rest_until_ = kLongAgo;
  Instant gateway_due_ = kLongAgo;  // when the gateway has used less than its share
  Instant deciding_ = kLongAgo;     // `now` of the last next()
  // What was computed for this time: a longer use does not fit if a shorter one does not.
  Duration fits_{};
  Duration fits_not_ = Duration::max();
};

// Passes the outcome of an exchange to the device, the waiting reads or commands, and the pending
// responses. Repeats a failed exchange if that is safe; counts its cause. On the bus's thread.
class OutcomeRouter {
 public:
  OutcomeRouter(BusParts& parts, Arbiter& arbiter);

  // Returns Reopen if the port must be opened again.
  [[nodiscard]] std::optional<Reopen> conclude(bool done, Instant now, ActionSink& sink);
  // The connection was lost during this exchange: a gateway may close it for one device alone.
  void connection_lost(const Flight& flight, Cause cause, Instant now, ActionSink& sink);
  void take_late(const std::vector<LateResponseFilter::Late>& responses, Instant now,
                 ActionSink& sink);

  void take_unsolicited(const std::vector<UnsolicitedListener::Frame>& frames, Instant now,
                        ActionSink& sink);
  // Devices that should have sent a frame. Returns Reopen if the port must be opened again.
  [[nodiscard]] std::optional<Reopen> silent(const std::vector<DeviceIndex>& devices, Instant now,
                                             ActionSink& sink);

  void count(Cause cause) { causes_.add(cause); }
  [[nodiscard]] const CauseCounters& causes() const { return causes_; }

 private:
  void note_try(const Wire::Ended& ended, Instant now, ActionSink& sink);
  [[nodiscard]] bool may_repeat(Cause cause) const;
  void learn(const Flight& flight);
  void deliver(const Flight& flight, const Wire::Ended& ended, Instant now, ActionSink& sink);
  // For clients of the gateway.
  void share(const Flight& flight, const Wire::Ended& ended, Instant now, ActionSink& sink);
  // Returns true if the device went offline.
  bool device_failed(DeviceIndex device, const Wire::Ended& ended, bool connection_lost,
                     Instant now, ActionSink& sink);

  BusParts& parts_;
  const BusSetup& setup_;
  ChannelTable& channels_;
  CommandQueue& commands_;
  ReadPath& reads_;
  DeviceMonitor& devices_;
  LateResponseFilter& late_;
  Arbiter& arbiter_;
  CauseCounters causes_;
};

}  // namespace fieldcast
