#include <gtest/gtest.h>

#include "tests/bus/plant.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

TEST(Simulation, HealthyPlantKeepsEveryRefresh) {
  const BusSpec spec = plant(4, 20, "refresh: 1s");
  VirtualBus bus(spec, {}, 1);
  fill(bus, spec);
  bus.watch_from_now();
  const auto before = bus.engine().bus_report(bus.now());
  bus.run_until(bus.now() + 10min);
  const auto after = bus.engine().bus_report(bus.now());
  EXPECT_EQ(after.deadline_misses, before.deadline_misses);
  for (const auto& channel : bus.channels()) EXPECT_LE(channel.longest_gap, 1s);
  EXPECT_EQ(after.causes.total(), 0u);
}

TEST(Simulation, ScheduledWireRests) {
  const BusSpec spec = plant(2, 20, "refresh: 2s");
  VirtualBus bus(spec, {}, 1);
  bus.run_until(Instant{1min});
  (void)bus.engine().bus_report(bus.now());
  bus.run_until(Instant{2min});
  const auto report = bus.engine().bus_report(bus.now());
  EXPECT_GT(report.utilisation, 0.01);
  EXPECT_LT(report.utilisation, 0.15);
}

TEST(Simulation, IntensiveWireNeverRests) {
  const BusSpec spec = plant(2, 20, "refresh: 2s, mode: intensive");
  VirtualBus bus(spec, {}, 1);
  bus.run_until(Instant{10s});
  (void)bus.engine().bus_report(bus.now());
  bus.run_until(Instant{20s});
  EXPECT_GT(bus.engine().bus_report(bus.now()).utilisation, 0.99);
}

TEST(Simulation, ListsOfRangesBringEveryChannelItsOwnValue) {
  const BusSpec spec = dtc_plant("refresh: 1s");
  VirtualBus bus(spec, {}, 1);
  fill(bus, spec);
  bus.watch_from_now();
  const std::uint64_t before = bus.sends();
  bus.run_until(bus.now() + 1min);
  EXPECT_LE(bus.sends() - before, 80u);  // one request per second for all forty
  for (const auto& channel : bus.channels()) EXPECT_LE(channel.longest_gap, 1s);
}

TEST(Simulation, OneSeedReplaysBitForBit) {
  const BusSpec spec = plant(3, 10, "refresh: 1s");
  sim::BusFaults faults;
  faults.noise = 1e-4;
  faults.devices["unit-2"].loss = 0.1;
  const auto fingerprint = [&](std::uint64_t seed) {
    VirtualBus bus(spec, faults, seed);
    bus.run_until(Instant{2min});
    return bus.fingerprint();
  };
  EXPECT_EQ(fingerprint(7), fingerprint(7));
  EXPECT_NE(fingerprint(7), fingerprint(8));
}

TEST(Simulation, WritesToNeighboursTravelTogether) {
  std::string text =
      "bridge: test\nbuses:\n  - name: bus\n    port: { serial: /dev/none, baud: 19200 }\n    "
      "protocol: modbus-rtu\n    devices:\n"
      "      - { name: unit, address: 1, refresh: 5s, access: read-write, channels: [";
  for (int r = 0; r < 40; ++r)
    text += (r ? "," : "") + std::string(" { name: r") + std::to_string(r) +
            ", at: \"holding:" + std::to_string(100 + r) + "\", type: uint16 }";
  const BusSpec spec = config::load_text(text + " ] }\n", "plant.yaml", {})->buses.front();
  VirtualBus bus(spec, {}, 3);
  bus.run_until(Instant{10s});
  const auto requests = [&] {
    return bus.plant().members()[0].device->statistics().write_requests;
  };
  for (ChannelIndex c = 0; c < 40; ++c) {
    Command command = write_of(spec, c, 1000 + c);
    command.verify = c == 39;
    bus.command(std::move(command));
  }
  bus.command(write_of(spec, 7, 77));  // the same channel again: the later value applies
  bus.run_until(Instant{20s});
  EXPECT_LE(requests(), 4u);  // the first was sent immediately
  for (const auto& [id, results] : bus.results()) {
    ASSERT_EQ(results.size(), 1u);
    EXPECT_EQ(results[0].state, id == 40 ? CommandState::kVerified : CommandState::kDone)
        << results[0].reason;
  }
  EXPECT_EQ(bus.results().size(), 41u);
  for (ChannelIndex c = 0; c < 40; ++c)
    EXPECT_EQ(bus.channels()[c].value, Value{std::uint64_t{c == 7 ? 77u : 1000u + c}}) << c;
}

TEST(Simulation, ACommandThatReadsThousandRegistersDelaysNoChannel) {
  BusSpec spec = plant(2, 20, "refresh: 1s");
  spec.devices.back().allow_raw_read = true;
  VirtualBus bus(spec, {}, 9);
  bus.run_until(Instant{5s});
  bus.watch_from_now();
  Command command;
  command.device = spec.devices.back().name;
  command.operation = Operation::kAcquire;
  command.target = AddressTarget{"holding:0", {}};
  command.count = 1000;
  bus.command(std::move(command));
  bus.run_until(bus.now() + 10s);
  ASSERT_EQ(bus.results().size(), 1u);
  const CommandResult& result = bus.results().begin()->second.front();
  EXPECT_EQ(result.state, CommandState::kDone) << result.reason;
  EXPECT_EQ(result.values.size(), 1000u);
  for (const auto& channel : bus.channels()) EXPECT_LE(channel.longest_gap, 1s);
}

TEST(Simulation, FloodOfCommandsStarvesNeitherSide) {
  const BusSpec spec = plant(2, 20, "refresh: 1s, mode: intensive");
  VirtualBus bus(spec, {}, 9);
  bus.run_until(Instant{5s});
  bus.watch_from_now();
  for (int i = 0; i < 3000; ++i) {
    bus.command(write_of(spec, static_cast<ChannelIndex>(i % 40), static_cast<std::uint64_t>(i)));
    bus.run_until(bus.now() + 5ms);  // far more than the wire carries
  }
  bus.run_until(bus.now() + 2min);
  std::uint64_t done = 0;
  std::uint64_t refused = 0;
  for (const auto& [id, results] : bus.results()) {
    done += results.front().state == CommandState::kDone;
    refused += results.front().cause == Cause::kQueueFull;
  }
  EXPECT_EQ(done + refused, 3000u);
  EXPECT_GT(done, 1000u);
  for (const auto& channel : bus.channels()) EXPECT_LE(channel.longest_gap, 1s);
}

}  // namespace
}  // namespace fieldcast::test
