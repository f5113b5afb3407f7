// Equal values at different addresses: their responses could be repetitions.
#include <gtest/gtest.h>

#include "tests/bus/plant.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// Requests of a minute, on a wire that never rests, with one register for each.
std::uint64_t requests_of_a_minute(bool equal_values, Duration spread) {
  const BusSpec spec = plant(2, 12, "refresh: 2s, mode: intensive, max-block: 1");
  sim::BusFaults faults;
  for (const DeviceSpec& device : spec.devices) faults.devices[device.name].delay = {3ms, spread};
  VirtualBus bus(spec, faults, 1);
  for (std::size_t d = 0; d < spec.devices.size(); ++d) {
    for (const ChannelSpec& channel : spec.devices[d].channels)
      EXPECT_TRUE(bus.plant().members()[d].device->poke("holding", channel.range.first,
                                                        equal_values ? 7 : channel.range.first));
  }
  bus.run_until(Instant{10s});
  const std::uint64_t before = bus.sends();
  bus.watch_from_now();
  bus.run_until(bus.now() + 1min);
  EXPECT_EQ(bus.engine().bus_report(bus.now()).causes.total(), 0u);
  for (const auto& channel : bus.channels()) EXPECT_EQ(channel.bad, 0u);
  return bus.sends() - before;
}

TEST(EqualValues, CostNothingIfTheDeviceRespondsEvenly) {
  EXPECT_EQ(requests_of_a_minute(true, 0ms), requests_of_a_minute(false, 0ms));
}

TEST(EqualValues, CostAtMostTheSpreadOfTheResponseTimes) {
  const auto equal = static_cast<double>(requests_of_a_minute(true, 2ms));
  const auto different = static_cast<double>(requests_of_a_minute(false, 2ms));
  EXPECT_GT(60 / equal, 60 / different) << "nothing waited";
  EXPECT_LT(60 / equal, 60 / different + 0.002);
}

}  // namespace
}  // namespace fieldcast::test
