#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/bus/plant.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// The loader reports an overload by configuration; the engine reports one by interests.
TEST(Simulation, OverloadIsReportedWhenItBeginsAndWhenItEnds) {
  BusSpec spec = plant(1, 200, "refresh: 1s");
  auto& channels = spec.devices[0].channels;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    channels[c].range.first = static_cast<std::uint32_t>(150 * c);
    channels[c].on_interest = c >= 20;
  }
  VirtualBus bus(spec, {}, 1);
  bus.run_until(Instant{10s});
  EXPECT_TRUE(bus.notices().empty());
  for (ChannelIndex c = 20; c < channels.size(); ++c) bus.set_interest(c, 1s);
  bus.run_until(Instant{20s});
  for (ChannelIndex c = 20; c < channels.size(); ++c) bus.set_interest(c, std::nullopt);
  bus.run_until(Instant{30s});
  ASSERT_EQ(bus.notices().size(), 2u);
  EXPECT_EQ(bus.notices()[0].kind, Notice::Kind::kOverload);
  EXPECT_EQ(bus.notices()[1].kind, Notice::Kind::kOverloadEnded);

  for (ChannelSpec& channel : channels) channel.on_interest = false;
  VirtualBus full(spec, {}, 1);
  full.run_until(Instant{10s});
  EXPECT_GT(full.engine().bus_report(full.now()).stretch, 1.0);
  EXPECT_TRUE(full.notices().empty());
}

int told(const VirtualBus& bus, Notice::Kind kind) {
  return static_cast<int>(std::ranges::count(bus.notices(), kind, &Notice::kind));
}

// The loader reports overloads by configuration and assumes responses after 5 ms.
TEST(Simulation, OverloadIsReportedOnceWhenDevicesAreSlowerThanAssumed) {
  sim::BusFaults faults;
  for (int d = 1; d <= 16; ++d) faults.devices["unit-" + std::to_string(d)].delay.base = 20ms;
  VirtualBus slow(plant(16, 1, "refresh: 400ms"), faults, 1);
  slow.run_until(Instant{4s});
  EXPECT_EQ(told(slow, Notice::Kind::kOverload), 0);
  slow.run_until(Instant{2min});
  EXPECT_EQ(told(slow, Notice::Kind::kOverload), 1);
  (void)slow.engine().bus_report(slow.now());
  slow.watch_from_now();
  slow.run_until(Instant{3min});
  EXPECT_EQ(told(slow, Notice::Kind::kOverloadEnded), 0);
  const auto report = slow.engine().bus_report(slow.now());
  EXPECT_GT(report.measured_load, 0.95);
  EXPECT_GT(report.stretch, 1.1);
  for (const auto& channel : slow.channels())
    EXPECT_LT(to_seconds(channel.longest_gap), 0.4 * 1.05 * report.stretch);
}

TEST(Simulation, OverloadEndsWhenDevicesRespondSooner) {
  VirtualBus enough(plant(16, 1, "refresh: 250ms"), {}, 1);
  EXPECT_GT(enough.engine().bus_report(Instant{}).stretch, 1.0);
  enough.run_until(Instant{1min});
  EXPECT_EQ(enough.engine().bus_report(enough.now()).stretch, 1.0);
  EXPECT_EQ(told(enough, Notice::Kind::kOverload), 0);
  EXPECT_EQ(told(enough, Notice::Kind::kOverloadEnded), 1);
}

TEST(Simulation, WhatAnOverloadedBusHasNotReadYetSaysSo) {
  const BusSpec spec = plant(16, 12, "refresh: 150ms");
  std::vector<bool> read(16 * 12);
  std::size_t waiting = 0;
  sim::VirtualBus bus(spec, {}, 1, [&](const Action& action) {
    const auto* publish = std::get_if<Publish>(&action);
    if (publish == nullptr) return;
    for (const Sample& sample : publish->samples) {
      if (sample.quality == Quality::kGood) read[sample.channel] = true;
      if (read[sample.channel]) continue;
      ++waiting;
      EXPECT_EQ(sample.quality, Quality::kNotYetRead) << sample.channel;
      EXPECT_EQ(sample.acquired, kLongAgo);
    }
  });
  bus.run_until(Instant{20s});
  EXPECT_GT(waiting, 0u);
  EXPECT_TRUE(std::ranges::all_of(read, [](bool each) { return each; }));
}

}  // namespace
}  // namespace fieldcast::test
