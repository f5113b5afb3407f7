// The parts of a bus engine, each with its own state. The engine, the arbiter (before an exchange)
// and the outcome router (after it) coordinate them. Owned by the bus engine, on the bus's thread.
#pragma once

#include <string>

#include "core/bus/command/channel_table.hpp"
#include "core/bus/command/command_queue.hpp"
#include "core/bus/health/device_monitor.hpp"
#include "core/bus/read_path.hpp"
#include "core/bus/setup/bus_setup.hpp"
#include "core/bus/wire/late_response_filter.hpp"
#include "core/bus/wire/wire.hpp"
#include "core/bus/wire/wire_fence.hpp"

namespace fieldcast {

struct BusParts {
  BusParts(const BusSpec& spec, TextCodec& codec)
      : setup(spec),
        channels(setup.spec(), codec),
        commands(setup, channels, codec),
        reads(setup, channels),
        devices(setup, reads.first_ranges()),
        late(setup),
        wire(setup),
        fence(setup.spec()) {}

  const BusSetup setup;
  ChannelTable channels;
  CommandQueue commands;
  ReadPath reads;
  DeviceMonitor devices;
  LateResponseFilter late;
  Wire wire;
  WireFence fence;
};

// "press-1: read holding:100..109 (oil-temperature, running, +3)"; empty without a request.
[[nodiscard]] std::string flight_text(const BusParts& parts);

}  // namespace fieldcast
