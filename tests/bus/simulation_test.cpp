// Whole buses in virtual time, with everything that goes wrong in a plant.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "config/loader.hpp"
#include "tests/bus/virtual_bus.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// `devices` devices with `registers` writable holding registers each, two apart; the register at
// address a holds value_of(device, a).
BusSpec plant(int devices, int registers, const std::string& defaults) {
  std::string text =
      "bridge: test\nbuses:\n  - name: bus\n    port: { serial: /dev/none, baud: 19200, format: "
      "8E1 }\n    protocol: "
      "modbus-rtu\n    defaults: { " +
      defaults + " }\n    devices:\n";
  for (int d = 1; d <= devices; ++d) {
    text += "      - name: unit-" + std::to_string(d) + "\n        address: " + std::to_string(d) +
            "\n        channels:\n";
    for (int r = 0; r < registers; ++r)
      text += "          - { name: r" + std::to_string(r) +
              ", at: \"holding:" + std::to_string(100 + 2 * r) +
              "\", type: uint16, access: read-write }\n";
  }
  const auto loaded = config::load_text(text, "plant.yaml", {});
  if (!loaded) throw std::runtime_error(to_text(loaded.error().front()));
  return loaded->buses.front();
}

std::uint64_t value_of(ChannelIndex channel) { return (channel * 2654435761u) >> 16 & 0xFFFF; }

Command write_of(const BusSpec& spec, ChannelIndex channel, std::uint64_t value) {
  Command command;
  for (const DeviceSpec& device : spec.devices) {
    if (channel < device.channels.size()) {
      command.device = device.name;
      command.target = ChannelTarget{device.channels[channel].name};
      break;
    }
    channel -= static_cast<ChannelIndex>(device.channels.size());
  }
  command.values = {Value{value}};
  return command;
}

// Gives every register its own value, so that a value of another register is recognised.
void fill(VirtualBus& bus, const BusSpec& spec) {
  for (ChannelIndex c = 0; c < bus.channels().size(); ++c) {
    bus.command(write_of(spec, c, value_of(c)));
    bus.run_until(bus.now() + 500ms);
  }
  for (const auto& [id, results] : bus.results())
    ASSERT_EQ(results.front().state, CommandState::kDone) << results.front().reason;
  bus.run_until(bus.now() + 5s);
  bus.judge = [](ChannelIndex channel, const Value& value) {
    if (std::get<std::uint64_t>(value) == value_of(channel)) return std::string{};
    return "channel " + std::to_string(channel) + " shows " + to_text(value) +
           ", its register holds " + std::to_string(value_of(channel));
  };
}

// Of refreshes that no wire carries the user is told when they are loaded; what stations want on
// top is told while it lasts.
TEST(Simulation, OverloadIsToldWhenItBeginsAndWhenItEnds) {
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

int told(const VirtualBus& bus, Notice::Kind kind) {
  return static_cast<int>(std::ranges::count(bus.notices(), kind, &Notice::kind));
}

// What the configuration asks of devices that answer after 5 ms is told when it is loaded, not by
// the engine.
TEST(Simulation, OverloadIsToldOnceWhenDevicesAreSlowerThanAssumed) {
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

TEST(Simulation, OverloadEndsWhenDevicesAnswerSooner) {
  VirtualBus enough(plant(16, 1, "refresh: 250ms"), {}, 1);
  EXPECT_GT(enough.engine().bus_report(Instant{}).stretch, 1.0);
  enough.run_until(Instant{1min});
  EXPECT_EQ(enough.engine().bus_report(enough.now()).stretch, 1.0);
  EXPECT_EQ(told(enough, Notice::Kind::kOverload), 0);
  EXPECT_EQ(told(enough, Notice::Kind::kOverloadEnded), 1);
}

// Three times as much as the wire carries.
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

TEST(Simulation, ADeviceThatIsDeafAfterItsAnswersKeepsItsRefreshes) {
  for (const Duration deaf : {Duration{8ms}, Duration{30ms}, Duration{120ms}}) {
    const BusSpec spec = plant(2, 6, "refresh: 500ms");
    BusSpec scattered = spec;  // several reads for each round
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
      EXPECT_EQ(channel.quality, Quality::kBadNoAnswer);
    } else {
      EXPECT_LE(channel.longest_gap, 1s) << "channel " << c;
    }
  }
  EXPECT_EQ(bus.engine().device_report(3, bus.now()).state, DeviceState::kOffline);
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
  faults.devices["unit-1"].refused.push_back(
      {"holding", 120, 121, 2});  // r10, and the gap behind it
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
      true;  // every odd address between our registers is refused
  VirtualBus bus(spec, faults, 6);
  bus.run_until(Instant{30s});
  bus.watch_from_now();
  bus.run_until(Instant{5min});
  for (const auto& channel : bus.channels()) EXPECT_EQ(channel.quality, Quality::kGood);
}

// Scattered variables of three types in one DTC device.
BusSpec dtc_plant(const std::string& defaults) {
  std::string text =
      "bridge: test\nbuses:\n  - name: bus\n    port: { serial: /dev/none, baud: 19200, format: "
      "8N1 }\n    protocol: dtc\n    "
      "defaults: { " +
      defaults + " }\n    devices:\n      - name: unit\n        address: 1\n        channels:\n";
  for (int i = 0; i < 40; ++i) {
    const std::string at = i % 3 == 0 ? "int16" : i % 3 == 1 ? "int32" : "float64";
    const std::string type = i % 3 == 0 ? "uint16" : i % 3 == 1 ? "uint32" : "uint64";
    text += "          - { name: v" + std::to_string(i) + ", at: \"" + at + ":" +
            std::to_string(100 + 37 * i) + "\", type: " + type + ", access: read-write }\n";
  }
  const auto loaded = config::load_text(text, "plant.yaml", {});
  if (!loaded) throw std::runtime_error(to_text(loaded.error().front()));
  return loaded->buses.front();
}

TEST(Simulation, ListsOfRangesBringEveryChannelItsOwnValue) {
  const BusSpec spec = dtc_plant("refresh: 1s");
  VirtualBus bus(spec, {}, 1);
  fill(bus, spec);
  bus.watch_from_now();
  const std::uint64_t before = bus.sends();
  bus.run_until(bus.now() + 1min);
  EXPECT_LE(bus.sends() - before, 80u);  // one request a second for all forty
  for (const auto& channel : bus.channels()) EXPECT_LE(channel.longest_gap, 1s);
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

// What the device accepts is learned from its refusals, told, and forgotten when another one may be
// there.
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
  EXPECT_NEAR(to_seconds(learned.areas[0].answer_time), 0.002, 0.0005);
  EXPECT_EQ(learned.pause, Duration::zero());
  bus.run_until(Instant{75s});
  const DeviceReport lost = bus.engine().device_report(0, bus.now());
  EXPECT_TRUE(lost.refused_gaps.empty());
  EXPECT_TRUE(lost.areas.empty());
}

// Noise, loss, late answers, silences, an unplugged port, and a stream of commands: for many seeds.
class Storm : public testing::TestWithParam<int> {};

TEST_P(Storm, NoWrongValueNoLostCommandNoStarvation) {
  const auto seed = static_cast<std::uint64_t>(GetParam());
  BusSpec spec = plant(5, 10, "refresh: 2s, timeout: 150ms, retries: 1");
  if (seed % 5 == 0) spec.planner = Planner::kDynamicBlocks;
  sim::BusFaults faults;
  faults.noise = 2e-5;
  faults.devices["unit-1"].loss = 0.05;
  faults.devices["unit-2"].late_probability = 0.05;
  faults.devices["unit-2"].late = 90ms;
  faults.devices["unit-3"].truncate = 0.05;
  faults.devices["unit-3"].stray = 0.1;
  faults.devices["unit-4"].garble = 0.2;
  // Registers are filled on a healthy plant first; each device is dead for a while later.
  const Duration filled = 60s;
  faults.devices["unit-5"].silence.push_back({filled + 60s, filled + 120s});
  VirtualBus bus(spec, faults, seed);
  std::mt19937_64 random(seed);
  for (ChannelIndex c = 0; c < bus.channels().size(); ++c) {
    Command command = write_of(spec, c, value_of(c));
    command.verify = true;
    // A sick device may need several attempts.
    for (int attempt = 0; attempt < 20; ++attempt) {
      bus.command(command);
      bus.run_until(bus.now() + 800ms);
      if (bus.results().at(bus.commands_sent()).front().state == CommandState::kVerified) break;
    }
    ASSERT_EQ(bus.results().at(bus.commands_sent()).front().state, CommandState::kVerified)
        << bus.results().at(bus.commands_sent()).front().reason;
  }
  bus.run_until(bus.now() + 5s);
  bus.judge = [](ChannelIndex channel, const Value& value) {
    if (std::get<std::uint64_t>(value) == value_of(channel)) return std::string{};
    return "channel " + std::to_string(channel) + " shows " + to_text(value) +
           ", its register holds " + std::to_string(value_of(channel));
  };
  bus.watch_from_now();
  const Instant end = bus.now() + 10min;
  const Instant unplugged = bus.now() + 200s;
  bool out = false;
  while (bus.now() < end) {
    bus.run_until(bus.now() + Duration{static_cast<std::int64_t>(random() % 2'000'000'000)});
    if (!out && bus.now() > unplugged && bus.now() < unplugged + 20s) {
      bus.unplug();
      bus.run_until(bus.now() + 15s);
      bus.plug();
      out = true;
    }
    const auto channel = static_cast<ChannelIndex>(random() % bus.channels().size());
    Command command = write_of(spec, channel, value_of(channel));
    command.verify = random() % 2 == 0;
    if (random() % 4 == 0) {
      command.operation = Operation::kAcquire;
      command.values.clear();
    }
    command.expires = bus.now() + 5s;
    bus.command(std::move(command));
  }
  bus.stop();
  for (std::uint64_t id = 1; id <= bus.commands_sent(); ++id)
    EXPECT_EQ(bus.results().count(id), 1u) << "command " << id << " was never answered";
  for (ChannelIndex c = 0; c < bus.channels().size(); ++c)
    EXPECT_GT(bus.channels()[c].good, 100u) << "channel " << c << " starves";
}

INSTANTIATE_TEST_SUITE_P(Seeds, Storm, testing::Range(1, 41));

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

// A recipe: many setpoints of one device at once.
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
  bus.command(write_of(spec, 7, 77));  // the same again: the later one holds
  bus.run_until(Instant{20s});
  EXPECT_LE(requests(), 4u);  // the first found the wire free
  for (const auto& [id, results] : bus.results()) {
    ASSERT_EQ(results.size(), 1u);
    EXPECT_EQ(results[0].state, id == 40 ? CommandState::kVerified : CommandState::kDone)
        << results[0].reason;
  }
  EXPECT_EQ(bus.results().size(), 41u);
  for (ChannelIndex c = 0; c < 40; ++c)
    EXPECT_EQ(bus.channels()[c].value, Value{std::uint64_t{c == 7 ? 77u : 1000u + c}}) << c;
}

TEST(Simulation, FloodOfCommandsStarvesNeitherSide) {
  const BusSpec spec = plant(2, 20, "refresh: 1s, mode: intensive");
  VirtualBus bus(spec, {}, 9);
  bus.run_until(Instant{5s});
  bus.watch_from_now();
  for (int i = 0; i < 3000; ++i) {
    bus.command(write_of(spec, static_cast<ChannelIndex>(i % 40), static_cast<std::uint64_t>(i)));
    bus.run_until(bus.now() + 5ms);  // far more than the wire can carry
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
