// `silence: learn` of a whole bus in virtual time.
#include <gtest/gtest.h>

#include "tests/bus/plant.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

BusSpec fast_line(const std::string& silence) {
  BusSpec spec = plant(4, 6, "refresh: 10ms, timeout: 100ms, silence: " + silence);
  std::get<SerialPortSpec>(spec.port).line.baud = 115200;
  for (DeviceSpec& device : spec.devices) {
    for (std::size_t c = 0; c < device.channels.size(); ++c)
      device.channels[c].range.first = static_cast<std::uint32_t>(1000 + 200 * c);
  }
  return spec;
}

struct Minute {
  std::uint64_t exchanges = 0, failures = 0;
  Duration silence{};
};
Minute minute_of(const std::string& silence, const sim::BusFaults& faults = {}) {
  VirtualBus bus(fast_line(silence), faults, 1);
  bus.run_until(Instant{1min});
  const BusReport before = bus.engine().bus_report(bus.now());
  bus.run_until(Instant{2min});
  const BusReport after = bus.engine().bus_report(bus.now());
  std::uint64_t failures = 0;
  for (DeviceIndex device = 0; device < 4; ++device)
    failures += bus.engine().device_report(device, bus.now()).failures;
  return {after.exchanges - before.exchanges, failures, after.silence};
}

TEST(LearnedSilence, AFastLineReadsMoreThanWithTheStandard) {
  const Minute standard = minute_of("standard"), learned = minute_of("learn");
  EXPECT_EQ(standard.silence, 1750us);
  EXPECT_LT(learned.silence, 600us);
  EXPECT_EQ(learned.failures, 0u);
  RecordProperty("ratio", std::to_string(static_cast<double>(learned.exchanges) /
                                         static_cast<double>(standard.exchanges)));
  EXPECT_GT(static_cast<double>(learned.exchanges), 1.15 * static_cast<double>(standard.exchanges));
}

TEST(LearnedSilence, NeverBelowTheConfiguredLeast) {
  EXPECT_GE(minute_of("learn 1ms").silence, 1ms);
}

TEST(LearnedSilence, ADeviceThatNeedsMoreGetsMore) {
  sim::BusFaults faults;
  faults.devices["unit-2"].deaf = 700us;
  const Minute learned = minute_of("learn", faults);
  EXPECT_GE(learned.silence, 700us);
  EXPECT_LT(learned.silence, 1750us);
  EXPECT_LE(learned.failures, 4u);
}

}  // namespace
}  // namespace fieldcast::test
