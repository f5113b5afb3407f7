// Reads of devices that are not configured, on a simulated line of 19 200 baud, in virtual time.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/bus/command/device_probe.hpp"
#include "tests/bus/plant.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// The last device of the plant is not configured.
struct Newcomer {
  explicit Newcomer(const std::string& defaults, const sim::BusFaults& faults = {})
      : whole(plant(5, 20, defaults)), bus(whole, faults, 5) {}

  // Writes a value of its own to each register, then removes the device from the engine.
  void remove() {
    fill(bus, whole);
    configure_the_others();
  }
  // The same, if the device often does not respond in time.
  void remove_late_one() {
    for (ChannelIndex c = 80; c < 100; ++c) {
      do {
        bus.command(write_of(whole, c, value_of(c)));
        bus.run_until(bus.now() + 5s);
      } while (bus.results().at(bus.commands_sent()).front().state != CommandState::kDone);
    }
    configure_the_others();
  }
  void configure_the_others() {
    BusSpec rest = whole;
    device = rest.devices.back();
    rest.devices.pop_back();
    bus.configure(rest);
    bus.run_until(bus.now() + 5s);
    missed = misses();
    bus.watch_from_now();
  }
  [[nodiscard]] std::uint64_t misses() {
    return bus.engine().bus_report(bus.now()).deadline_misses;
  }
  // Probes the devices to the end, as the bridge does.
  std::vector<ProbedDevice> probe(std::vector<DeviceSpec> devices, Duration limit,
                                  std::size_t questions = 0) {
    DeviceProbe probe(std::move(devices), bus.now() + limit, questions);
    while (const auto command = probe.next()) {
      bus.command(*command);
      const std::uint64_t id = bus.commands_sent();
      while (!bus.results().contains(id)) bus.run_until(bus.now() + 1ms);
      EXPECT_TRUE(bus.results().at(id).front().ad_hoc);
      probe.on_result(bus.results().at(id).front());
    }
    return probe.devices();
  }
  [[nodiscard]] DeviceSpec at_address(std::uint16_t address) const {
    DeviceSpec other = device;
    other.name = "at-" + std::to_string(address);
    other.link.address = address;
    return other;
  }

  BusSpec whole;
  VirtualBus bus;
  DeviceSpec device;
  std::uint64_t missed = 0;
};

void expect_values(const Newcomer& plant, const ProbedDevice& probed) {
  ASSERT_EQ(probed.channels.size(), 20u);
  for (unsigned i = 0; i < 20; ++i) {
    EXPECT_EQ(probed.channels[i].name, plant.device.channels[i].name);
    EXPECT_EQ(probed.channels[i].reason, "");
    EXPECT_EQ(probed.channels[i].value, Value{value_of(80 + i)});
    EXPECT_TRUE(probed.channels[i].responded);
  }
}

TEST(AdHoc, ADeviceThatIsNotConfiguredIsReadAndThePlanKeepsEveryRefresh) {
  for (const char* defaults : {"refresh: 2s", "refresh: 1s", "refresh: 1s, mode: intensive"}) {
    Newcomer plant(defaults);
    plant.remove();
    for (int i = 0; i < 10; ++i) {
      const auto probed = plant.probe({plant.device}, 60s);
      ASSERT_EQ(probed.size(), 1u) << defaults;
      expect_values(plant, probed.front());
    }
    EXPECT_EQ(plant.misses(), plant.missed) << defaults;
  }
}

TEST(AdHoc, OnlySingleChannelsAreRead) {
  Newcomer plant("refresh: 1s");
  plant.remove();
  const auto cause = [&](Operation operation,
                         const std::variant<ChannelTarget, AddressTarget>& at) {
    Command command;
    command.requester = "test";
    command.device = plant.device.name;
    command.operation = operation;
    command.target = at;
    if (operation == Operation::kWrite) command.values = {std::uint64_t{1}};
    command.ad_hoc = std::make_shared<const DeviceSpec>(plant.device);
    command.expires = plant.bus.now() + 60s;
    plant.bus.command(command);
    plant.bus.run_until(plant.bus.now() + 10s);
    return plant.bus.results().at(plant.bus.commands_sent()).front().cause;
  };
  EXPECT_EQ(cause(Operation::kAcquire, ChannelTarget{"r0"}), Cause::kNone);
  EXPECT_EQ(cause(Operation::kAcquire, ChannelTarget{}), Cause::kUnsupported) << "all of them";
  EXPECT_EQ(cause(Operation::kAcquire, AddressTarget{"holding:100", {}}), Cause::kUnsupported);
  EXPECT_EQ(cause(Operation::kWrite, ChannelTarget{"r0"}), Cause::kUnsupported);
}

TEST(AdHoc, ASearchOfSilentAddressesCostsNoRefresh) {
  Newcomer plant("refresh: 1s");
  plant.remove();
  std::vector<DeviceSpec> devices;
  for (std::uint16_t address = 11; address < 26; ++address)
    devices.push_back(plant.at_address(address));
  devices.push_back(plant.device);
  const auto probed = plant.probe(devices, 300s, plant.device.channels.size());
  ASSERT_EQ(probed.size(), 16u);
  for (std::size_t i = 0; i < 15; ++i) {
    ASSERT_EQ(probed[i].channels.size(), DeviceProbe::kMostSilent) << probed[i].name;
    for (const ProbedChannel& channel : probed[i].channels) {
      EXPECT_EQ(channel.cause, Cause::kNoResponse) << channel.reason;
      EXPECT_FALSE(channel.responded);
      EXPECT_LE(channel.took, plant.device.timeout + 20ms);
    }
  }
  ASSERT_EQ(probed.back().channels.size(), 1u);
  EXPECT_EQ(probed.back().channels.front().value, Value{value_of(80)});
  EXPECT_EQ(plant.misses(), plant.missed);
  EXPECT_TRUE(std::ranges::none_of(plant.bus.notices(), [](const Notice& notice) {
    return notice.kind == Notice::Kind::kDeviceLost || notice.kind == Notice::Kind::kGarbage;
  }));
}

TEST(AdHoc, WithoutFreeTimeNothingIsSent) {
  Newcomer plant("refresh: 1s");
  plant.remove();
  plant.device.timeout = 2s;  // if it is silent, the plan misses refreshes
  const auto probed = plant.probe({plant.device, plant.at_address(9)}, 20s);
  ASSERT_EQ(probed.size(), 1u) << "the rest would expire, too";
  ASSERT_EQ(probed.front().channels.size(), 1u);
  EXPECT_EQ(probed.front().channels.front().cause, Cause::kExpired);
  EXPECT_EQ(plant.misses(), plant.missed);
}

// Its responses arrive during the requests to other devices. `judge` compares each published value.
TEST(AdHoc, ALateResponseIsNeverAValueOfAnotherDevice) {
  for (const Duration late : {205ms, 230ms, 300ms, 450ms}) {
    sim::BusFaults faults;
    faults.devices["unit-5"].late_probability = 1;
    faults.devices["unit-5"].late = late;
    Newcomer plant("refresh: 1s", faults);
    for (ChannelIndex c = 0; c < 80; ++c) plant.bus.command(write_of(plant.whole, c, value_of(c)));
    plant.bus.run_until(Instant{120s});
    plant.bus.judge = [](ChannelIndex channel, const Value& value) {
      return value == Value{value_of(channel)} ? std::string{} : "it is of another register";
    };
    plant.device = plant.whole.devices.back();
    BusSpec rest = plant.whole;
    rest.devices.pop_back();
    plant.bus.configure(rest);
    plant.bus.run_until(plant.bus.now() + 5s);
    const auto good = plant.bus.channels().front().good;
    const auto sent = plant.bus.plant().members().back().dice.late();
    for (int i = 0; i < 20; ++i) {
      const auto probed = plant.probe({plant.device}, 60s);
      for (const ProbedChannel& channel : probed.front().channels)
        EXPECT_FALSE(channel.value) << "a value of an earlier request";
    }
    EXPECT_GT(plant.bus.channels().front().good, good + 5);
    EXPECT_GT(plant.bus.plant().members().back().dice.late(), sent + 20);
  }
}

TEST(AdHoc, WhatCouldDisturbTheBusIsRefused) {
  Newcomer plant("refresh: 1s");
  plant.remove();
  const auto refused = [&](const DeviceSpec& device) {
    const std::uint64_t sends = plant.bus.sends();
    const Instant before = plant.bus.now();
    const auto probed = plant.probe({device}, 60s);
    EXPECT_LE(plant.bus.now() - before, 100ms) << "every channel is refused at once";
    EXPECT_LE(plant.bus.sends(), sends + 20) << "only those of the plan";
    return probed.front().channels.front().reason;
  };
  EXPECT_EQ(refused(plant.at_address(2)), "its address is that of the device 'unit-2' of this bus");
  DeviceSpec other = plant.device;
  other.protocol = "modbus-ascii";
  EXPECT_EQ(refused(other), "no device of this bus has the protocol modbus-ascii");
  DeviceSpec nowhere = plant.at_address(600);
  EXPECT_EQ(refused(nowhere), "the protocol does not have this address");

  Command write;
  write.ad_hoc = std::make_shared<const DeviceSpec>(plant.device);
  write.target = ChannelTarget{"r0"};
  write.values = {Value{std::uint64_t{1}}};
  plant.bus.command(write);
  EXPECT_EQ(plant.bus.results().at(plant.bus.commands_sent()).front().cause, Cause::kUnsupported);
}

// Requests wait until no response to the earlier ones can arrive, so none is matched to them.
TEST(AdHoc, TheSameAddressCanBeReadAgainWithOtherChannels) {
  sim::BusFaults faults;
  faults.devices["unit-5"].late_probability = 0.5;
  faults.devices["unit-5"].late = 400ms;
  Newcomer plant("refresh: 1s", faults);
  plant.remove_late_one();
  unsigned values = 0;
  for (int i = 0; i < 40; ++i) {
    DeviceSpec device = plant.device;
    device.timeout = std::chrono::milliseconds{200 + i};  // late responses: within three of them
    std::rotate(device.channels.begin(), device.channels.begin() + i % 20, device.channels.end());
    const auto probed = plant.probe({device}, 60s);
    for (const ProbedChannel& channel : probed.front().channels) {
      EXPECT_NE(channel.cause, Cause::kQueueFull);
      const auto index = static_cast<ChannelIndex>(std::stoi(channel.name.substr(1)));
      values += channel.value.has_value();
      EXPECT_EQ(channel.value.value_or(Value{value_of(80 + index)}), Value{value_of(80 + index)});
    }
  }
  EXPECT_GT(values, 40u);
}

TEST(AdHoc, AClosedPortAndAStopEndTheProbe) {
  Newcomer plant("refresh: 1s");
  plant.remove();
  Command read = *DeviceProbe({plant.at_address(9)}, plant.bus.now() + 60s).next();
  plant.bus.command(read);
  plant.bus.stop();
  const auto& results = plant.bus.results().at(plant.bus.commands_sent());
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results.front().cause, Cause::kShutdown);
}

}  // namespace
}  // namespace fieldcast::test
