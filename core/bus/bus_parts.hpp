// The parts of a bus engine, each with its own state. The engine, the arbiter (before an exchange)
// and the outcome router (after it) coordinate them. Owned by the bus engine, on the bus's thread.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <string>

#include "core/bus/command/channel_table.hpp"
#include "core/bus/command/command_queue.hpp"
#include "core/bus/health/device_monitor.hpp"
#include "core/bus/read_path.hpp"
#include "core/bus/setup/bus_setup.hpp"
#include "core/bus/wire/in_flight.hpp"
#include "core/bus/wire/late_response_filter.hpp"
#include "core/bus/wire/unsolicited_listener.hpp"
#include "core/bus/wire/wire.hpp"
#include "core/bus/wire/wire_fence.hpp"
#include "core/calculate/calculator.hpp"

namespace fieldcast {

struct BusParts {
  BusParts(const BusSpec& spec, TextCodec& codec)
      : setup(spec),
        channels(setup.spec(), codec),
        calculator(setup.spec()),
        commands(setup, channels, codec),
        reads(setup, channels),
        devices(setup, reads.first_ranges()),
        late(setup),
        fence(setup.spec()),
        listener(setup),
        in_flight(setup.spec().in_flight) {
    for (unsigned i = 0; i < setup.spec().in_flight; ++i) wires.emplace_back(setup, session);
    wire_ = &wires.front();
  }

  BusSetup setup;  // changes only in admit()
  ChannelTable channels;
  Calculator calculator;
  CommandQueue commands;
  ReadPath reads;
  DeviceMonitor devices;
  LateResponseFilter late;
  Bytes session;  // of the connection, see ExchangeContext
  std::deque<Wire> wires;
  WireFence fence;
  UnsolicitedListener listener;
  FlightLimit in_flight;

  // Gives the ad-hoc device of a command an index. Fails if it could disturb the bus.
  [[nodiscard]] tl::expected<void, CommandFault> admit(const Command& command, Instant now);

  // The wire whose exchange begins or ends.
  [[nodiscard]] Wire& wire() { return *wire_; }
  [[nodiscard]] const Wire& wire() const { return *wire_; }
  void select(Wire& wire) { wire_ = &wire; }
  // Index in `wires`. Empty if no exchange sent these bytes last.
  [[nodiscard]] std::optional<std::size_t> sender_of(ByteView sent) const {
    const auto found = std::ranges::find_if(wires, [&](const Wire& wire) {
      return wire.exchanging() && std::ranges::equal(wire.driver().sent(), sent);
    });
    if (found == wires.end()) return std::nullopt;
    return static_cast<std::size_t>(found - wires.begin());
  }
  // At most one, see CommandQueue.
  [[nodiscard]] bool command_in_flight() const {
    return std::ranges::any_of(
        wires, [](const Wire& wire) { return wire.exchanging() && wire.flight().is_command(); });
  }
  [[nodiscard]] unsigned exchanging() const {
    return static_cast<unsigned>(std::ranges::count_if(wires, &Wire::exchanging));
  }

 private:
  Wire* wire_ = nullptr;
};

// "press-1: read holding:100..109 (oil-temperature, running, +3)".
[[nodiscard]] std::string flight_text(const BusParts& parts, const Flight& flight);

}  // namespace fieldcast
