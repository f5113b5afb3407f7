// Writes that no response follows, as those of many laboratory power supplies. Only reading back
// shows whether they took effect.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bus/virtual_bus.hpp"
#include "tests/support/declared_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::VirtualBus;

constexpr std::string_view kSupply = R"(
summary: a power supply
addresses: { from: 1, to: 1 }
areas: [{ name: state, record: true }]
operations:
  - name: read the voltage
    read: state
    request: [{ name: ask, constant: "VSET1?" }]
    answer: [{ name: voltage, is: value, text: "00.00" }]
  - name: set the voltage
    write: state
    no-response: 50ms
    request: [{ name: set, constant: "VSET1:" }, { name: voltage, is: value, text: "00.00" }]
)";

BusSpec supply() {
  return test::bus_by(R"(
bridge: b
buses:
  - name: bus
    port: { serial: /dev/ttyS0, baud: 9600 }
    protocol: supply
    defaults: { refresh: 500ms, timeout: 300ms }
    devices:
      - name: d
        address: 1
        channels: [{ name: voltage, at: voltage, type: float64, access: read-write }]
)",
                      "supply", kSupply);
}

CommandResult write(VirtualBus& bus, double value) {
  const std::size_t before = bus.results().size();
  bus.command({.requester = "test",
               .device = "d",
               .target = ChannelTarget{"voltage"},
               .values = {Value{value}}});
  bus.run_until(bus.now() + 3s);
  EXPECT_EQ(bus.results().size(), before + 1);
  return bus.results().empty() ? CommandResult{} : bus.results().rbegin()->second.front();
}

TEST(WriteWithoutResponse, IsReadBackThoughNobodyAskedForIt) {
  VirtualBus bus(supply(), {}, 1);
  bus.run_until(bus.now() + 2s);
  const CommandResult result = write(bus, 12.5);
  EXPECT_EQ(result.state, CommandState::kVerified) << result.reason;
  EXPECT_EQ(result.values, std::vector{Value{12.5}});
  // The pause, two requests and a response, without a timeout.
  EXPECT_GE(result.completed - result.started, 50ms);
  EXPECT_LT(result.completed - result.started, 150ms);
}

TEST(WriteWithoutResponse, DisturbsNoRefresh) {
  VirtualBus bus(supply(), {}, 1);
  bus.run_until(bus.now() + 5s);
  bus.watch_from_now();
  for (int i = 0; i < 10; ++i) write(bus, i);
  EXPECT_EQ(bus.channels()[0].bad, 0u);
  EXPECT_LE(bus.channels()[0].longest_gap, 500ms);
}

TEST(WriteWithoutResponse, FailsIfItWasLost) {
  sim::BusFaults faults;
  faults.devices["d"].loss = 1;
  VirtualBus bus(supply(), faults, 1);
  const CommandResult result = write(bus, 12.5);
  EXPECT_EQ(result.state, CommandState::kFailed);
  EXPECT_THAT(result.reason, testing::StartsWith("written, but reading back failed: "));
}

TEST(WriteWithoutResponse, DoesNotMakeASilentDeviceOnline) {
  sim::BusFaults faults;
  faults.devices["d"].loss = 1;
  VirtualBus bus(supply(), faults, 1);
  bus.run_until(bus.now() + 30s);
  write(bus, 12.5);
  EXPECT_THAT(bus.notices(),
              testing::Contains(testing::Field(&Notice::kind, Notice::Kind::kDeviceLost)));
  EXPECT_THAT(
      bus.notices(),
      testing::Not(testing::Contains(testing::Field(&Notice::kind, Notice::Kind::kDeviceBack))));
  EXPECT_EQ(bus.channels()[0].good, 0u);
}

}  // namespace
}  // namespace fieldcast
