#include <gtest/gtest.h>

#include <set>

#include "tests/bus/plant.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

TEST(Simulation, ADeviceThatIsDeafAfterItsResponsesKeepsItsRefreshes) {
  for (const Duration deaf : {Duration{8ms}, Duration{30ms}, Duration{120ms}}) {
    const BusSpec spec = plant(2, 6, "refresh: 500ms");
    BusSpec scattered = spec;  // several reads per round
    for (DeviceSpec& device : scattered.devices) {
      for (std::size_t c = 0; c < 3; ++c)
        device.channels[c].range.first = static_cast<std::uint32_t>(1000 + 200 * c);
    }
    sim::BusFaults faults;
    faults.devices["unit-1"].deaf = deaf;
    VirtualBus bus(deaf > 100ms ? spec : scattered, faults, 1);
    bus.run_until(Instant{2min});
    bus.watch_from_now();
    bus.run_until(Instant{5min});
    for (const auto& channel : bus.channels()) EXPECT_LE(channel.longest_gap, 500ms);
    const Duration pause = bus.engine().device_report(0, bus.now()).pause;
    EXPECT_LE(pause, 2 * deaf) << "deaf for " << to_text(deaf);
    EXPECT_EQ(bus.engine().device_report(1, bus.now()).pause, Duration::zero());
  }
}

TEST(Simulation, DeadDeviceCostsTheOthersNothing) {
  const BusSpec spec = plant(10, 12, "refresh: 1s, timeout: 200ms, retries: 1");
  sim::BusFaults faults;
  faults.devices["unit-4"].silence.push_back({30s, sim::kForever});
  VirtualBus bus(spec, faults, 2);
  bus.run_until(Instant{40s});
  bus.watch_from_now();
  bus.run_until(Instant{20min});
  for (ChannelIndex c = 0; c < bus.channels().size(); ++c) {
    const auto& channel = bus.channels()[c];
    if (c / 12 == 3) {
      EXPECT_EQ(channel.good, 0u);
      EXPECT_EQ(channel.quality, Quality::kBadNoResponse);
    } else {
      EXPECT_LE(channel.longest_gap, 1s) << "channel " << c;
    }
  }
  EXPECT_EQ(bus.engine().device_report(3, bus.now()).state, DeviceState::kOffline);
}

// The page names failed exchanges as the reason of LATE (bus_advice.ts): this is the case that it
// describes.
TEST(Simulation, OneMissingResponseMakesOtherChannelsLateOnlyIfItHoldsTheWireLongerThanTheySpare) {
  const auto late_after_one_silence = [](const char* defaults, Duration refresh) {
    const BusSpec spec = plant(4, 8, defaults);
    sim::BusFaults faults;
    faults.devices["unit-1"].silence.push_back({60s, 60s + refresh});
    VirtualBus bus(spec, faults, 1);
    bus.run_until(Instant{59s});
    const BusReport before = bus.engine().bus_report(bus.now());
    EXPECT_LT(before.planned_load, 0.45) << defaults;
    EXPECT_EQ(before.causes.total(), 0u);
    bus.run_until(Instant{90s});
    const BusReport after = bus.engine().bus_report(bus.now());
    EXPECT_GE(after.causes.total(), 1u) << defaults;
    EXPECT_LE(after.causes.total(), 2u) << defaults;
    return after.misses[Cause::kLate] - before.misses[Cause::kLate];
  };
  EXPECT_EQ(late_after_one_silence("refresh: 1s, timeout: 200ms, retries: 0", 1s), 0u);
  // 24 channels of the other devices miss one refresh or two.
  EXPECT_GE(late_after_one_silence("refresh: 350ms, timeout: 500ms, retries: 0", 350ms), 8u);
}

TEST(Simulation, DeadDeviceComesBackByItself) {
  const BusSpec spec = plant(3, 5, "refresh: 500ms, timeout: 100ms");
  sim::BusFaults faults;
  faults.devices["unit-2"].silence.push_back({10s, 300s});
  VirtualBus bus(spec, faults, 3);
  bus.run_until(Instant{290s});
  EXPECT_EQ(bus.engine().device_report(1, bus.now()).state, DeviceState::kOffline);
  bus.run_until(Instant{335s});  // the longest pause between two probes is 30 s
  EXPECT_EQ(bus.engine().device_report(1, bus.now()).state, DeviceState::kOnline);
  for (ChannelIndex c = 5; c < 10; ++c) EXPECT_EQ(bus.channels()[c].quality, Quality::kGood);
}

// Nothing is read from such a device, so no probe shows that it is back.
TEST(Simulation, ADeviceThatIsOnlyWrittenIsNotRefusedForEver) {
  BusSpec spec = plant(2, 1, "refresh: 500ms, timeout: 100ms, retries: 0");
  spec.devices[0].channels[0].access = Access::kWriteOnly;
  sim::BusFaults faults;
  faults.devices["unit-1"].silence.push_back({0s, 10s});
  VirtualBus bus(spec, faults, 1);
  const auto write = [&](Duration at) {
    bus.run_until(Instant{at});
    bus.command(write_of(spec, 0, 7));
    bus.run_until(Instant{at + 1s});
    return bus.results().rbegin()->second.front();
  };
  for (const Duration at : {Duration{1s}, Duration{3s}, Duration{5s}})
    EXPECT_EQ(write(at).state, CommandState::kFailed);
  EXPECT_EQ(bus.engine().device_report(0, bus.now()).state, DeviceState::kOffline);
  EXPECT_EQ(write(11s).state, CommandState::kDone);
  EXPECT_EQ(bus.engine().device_report(0, bus.now()).state, DeviceState::kOnline);
}

TEST(Simulation, ASlowDeviceComesBackOnAWireThatIsBusy) {
  BusSpec spec = plant(2, 1, "refresh: 60ms, timeout: 200ms");
  spec.devices[1].channels[0].refresh = 5s;
  sim::BusFaults faults;
  faults.devices["unit-2"].delay.base = 60ms;
  faults.devices["unit-2"].silence.push_back({60s, 180s});
  VirtualBus bus(spec, faults, 1);
  bus.run_until(Instant{170s});
  ASSERT_EQ(bus.engine().device_report(1, bus.now()).state, DeviceState::kOffline);
  bus.run_until(Instant{240s});
  EXPECT_EQ(bus.engine().device_report(1, bus.now()).state, DeviceState::kOnline);
  bus.watch_from_now();
  bus.run_until(Instant{300s});
  EXPECT_GE(bus.channels()[1].good, 5u);
}

TEST(Simulation, NobodyKnowsHowADeviceBehindAClosedPortIs) {
  VirtualBus bus(plant(1, 5, "refresh: 500ms"), {}, 3);
  bus.run_until(Instant{10s});
  EXPECT_EQ(bus.engine().device_report(0, bus.now()).state, DeviceState::kOnline);
  bus.unplug();
  bus.run_until(Instant{12s});
  EXPECT_EQ(bus.engine().device_report(0, bus.now()).state, DeviceState::kUnknown);
}

TEST(Simulation, HalfNoiseDeviceCostsTheOthersNothing) {
  const BusSpec spec = plant(10, 12, "refresh: 1s, timeout: 200ms, retries: 1");
  sim::BusFaults faults;
  faults.devices["unit-4"].garble = 0.5;
  VirtualBus bus(spec, faults, 4);
  bus.run_until(Instant{40s});
  bus.watch_from_now();
  bus.run_until(Instant{20min});
  for (ChannelIndex c = 0; c < bus.channels().size(); ++c) {
    if (c / 12 == 3)
      EXPECT_GT(bus.channels()[c].good, 100u);
    else
      EXPECT_LE(bus.channels()[c].longest_gap, 1s) << "channel " << c;
  }
}

TEST(Simulation, RefusedAddressLeavesTheOthersAlone) {
  const BusSpec spec = plant(1, 30, "refresh: 1s");
  sim::BusFaults faults;
  faults.devices["unit-1"].refused.push_back({"holding", 120, 121, 2});  // r10 and the gap after it
  VirtualBus bus(spec, faults, 5);
  bus.run_until(Instant{10s});
  bus.watch_from_now();
  bus.run_until(Instant{10min});
  for (ChannelIndex c = 0; c < bus.channels().size(); ++c) {
    if (c == 10)
      EXPECT_EQ(bus.channels()[c].quality, Quality::kBadDeviceError);
    else
      EXPECT_LE(bus.channels()[c].longest_gap, 1s) << "channel " << c;
  }
  EXPECT_EQ(bus.engine().device_report(0, bus.now()).refused,
            std::vector<std::string>{"holding:120"});
}

TEST(Simulation, RefusedGapIsNotBridgedAgain) {
  const BusSpec spec = plant(1, 30, "refresh: 1s");
  sim::BusFaults faults;
  faults.devices["unit-1"].only_configured =
      true;  // every odd address between the registers is refused
  VirtualBus bus(spec, faults, 6);
  bus.run_until(Instant{30s});
  bus.watch_from_now();
  bus.run_until(Instant{5min});
  for (const auto& channel : bus.channels()) EXPECT_EQ(channel.quality, Quality::kGood);
}

TEST(Simulation, RefusedRangesOfAListLeaveTheOthersAlone) {
  const BusSpec spec = dtc_plant("refresh: 2s");
  sim::BusFaults faults;
  faults.devices["unit"].refused.push_back({"int16", 100, 100, 2});            // v0
  faults.devices["unit"].refused.push_back({"int32", 100 + 37 * 13, 600, 2});  // v13
  VirtualBus bus(spec, faults, 5);
  bus.run_until(Instant{20s});
  bus.watch_from_now();
  bus.run_until(Instant{10min});
  for (ChannelIndex c = 0; c < bus.channels().size(); ++c) {
    if (c == 0 || c == 13)
      EXPECT_EQ(bus.channels()[c].quality, Quality::kBadDeviceError);
    else
      EXPECT_LE(bus.channels()[c].longest_gap, 2s) << "channel " << c;
  }
  EXPECT_EQ(bus.engine().device_report(0, bus.now()).refused,
            (std::vector<std::string>{"int16:100", "int32:581"}));
}

// Gaps that the device accepts are learned, and forgotten when the device may be replaced.
TEST(Simulation, LearnsGapsAndForgetsThemWithTheDevice) {
  const BusSpec spec = plant(1, 6, "refresh: 1s, timeout: 100ms");
  sim::BusFaults faults;
  faults.devices["unit-1"].only_configured = true;
  faults.devices["unit-1"].silence.push_back({60s, 80s});
  VirtualBus bus(spec, faults, 8);
  bus.run_until(Instant{30s});
  const DeviceReport learned = bus.engine().device_report(0, bus.now());
  EXPECT_EQ(learned.refused_gaps.size(), 5u);
  EXPECT_EQ(std::set<std::string>(learned.refused_gaps.begin(), learned.refused_gaps.end())
                .count("holding:103"),
            1u);
  ASSERT_EQ(learned.areas.size(), 1u);
  EXPECT_EQ(learned.areas[0].area, "holding");
  EXPECT_NEAR(to_seconds(learned.areas[0].response_time), 0.002, 0.0005);
  EXPECT_EQ(learned.pause, Duration::zero());
  bus.run_until(Instant{75s});
  const DeviceReport lost = bus.engine().device_report(0, bus.now());
  EXPECT_TRUE(lost.refused_gaps.empty());
  EXPECT_TRUE(lost.areas.empty());
}

}  // namespace
}  // namespace fieldcast::test
