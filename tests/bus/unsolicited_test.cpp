// Devices that send frames without a request, in virtual time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/bus/command/channel_table.hpp"
#include "core/bus/wire/unsolicited_listener.hpp"
#include "tests/bus/virtual_bus.hpp"
#include "tests/support/declared_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::VirtualBus;

// Sends its state by itself, and accepts commands and requests for its settings.
constexpr auto kScale = R"(
summary: a scale
addresses: { from: 1, to: 9 }
areas:
  - { name: weighing, record: true }
  - { name: settings, record: true }
  - { name: tare, trigger: true }
operations:
  - name: weight
    read: weighing
    unsolicited: 100ms
    answer:
      - { name: begin, constant: 2 }
      - { is: address }
      - { name: weight, is: value, text: decimal(7) }
      - { is: checksum, kind: xor, of: address..weight, as: hex, digits: 2 }
      - { name: end, constant: "\r\n" }
  - name: settings
    read: settings
    request: [{ name: ask, constant: "?" }, { is: address }, { name: end, constant: "\r\n" }]
    answer:
      - { name: begin, constant: "=" }
      - { is: address }
      - { name: zero-band, is: value, bytes: 2 }
      - { is: checksum, kind: xor, of: address..zero-band, as: hex, digits: 2 }
      - { name: end, constant: "\r\n" }
  - name: tare
    write: tare
    request: [{ name: ask, constant: "T" }, { is: address }, { name: end, constant: "\r\n" }]
    answer: [{ name: done, constant: "OK" }, { is: address }, { name: end, constant: "\r\n" }]
)";

BusSpec line(const std::string& devices) {
  return test::bus_by(
      "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0, baud: 19200 }\n"
      "    protocol: scale\n    devices:\n" +
          devices,
      "scale", kScale);
}

BusSpec two_scales() {
  return line(
      "      - { name: a, address: 1, channels: [{ name: w, at: weight, type: float64, "
      "refresh: 300ms }] }\n"
      "      - { name: b, address: 2, channels: [{ name: w, at: weight, type: float64, "
      "refresh: 300ms }] }\n");
}

TEST(Unsolicited, FramesAreSamplesAndNothingIsSent) {
  VirtualBus bus(two_scales(), {}, 1);
  bus.run_until(bus.now() + 10s);
  EXPECT_EQ(bus.sends(), 0u);
  for (const auto& channel : bus.channels()) {
    EXPECT_GE(channel.good, 98u);
    EXPECT_LE(channel.good, 101u);
    EXPECT_LE(channel.longest_gap, 110ms);
    EXPECT_EQ(channel.quality, Quality::kGood);
  }
  EXPECT_EQ(bus.engine().device_report(0, bus.now()).state, DeviceState::kOnline);
}

TEST(Unsolicited, SilenceIsAMissedRefreshWithItsCause) {
  sim::BusFaults faults;
  faults.devices["b"].silence = {{5s, 8s}};
  VirtualBus bus(two_scales(), faults, 1);
  bus.run_until(bus.now() + 5450ms);
  EXPECT_EQ(bus.channels()[0].quality, Quality::kGood);
  EXPECT_EQ(bus.channels()[1].quality, quality_of(Cause::kNoResponse));
  bus.run_until(bus.now() + 1s);
  EXPECT_EQ(bus.engine().device_report(1, bus.now()).state, DeviceState::kOffline);
  ASSERT_FALSE(bus.notices().empty());
  EXPECT_EQ(bus.notices().back().kind, Notice::Kind::kDeviceLost);
  EXPECT_EQ(bus.notices().back().text, "sends nothing any more");
  bus.run_until(bus.now() + 2s);
  EXPECT_EQ(bus.channels()[1].quality, Quality::kGood);
  EXPECT_EQ(bus.notices().back().kind, Notice::Kind::kDeviceBack);
  EXPECT_EQ(bus.channels()[0].bad, 0u);
}

TEST(Unsolicited, AChannelIsNotReadOnRequest) {
  VirtualBus bus(two_scales(), {}, 1);
  bus.run_until(bus.now() + 1s);
  Command command;
  command.operation = Operation::kAcquire;
  command.requester = "test";
  command.device = "a";
  command.target = ChannelTarget{"w"};
  bus.command(command);
  bus.run_until(bus.now() + 1s);
  ASSERT_EQ(bus.results().size(), 1u);
  const CommandResult& result = bus.results().begin()->second.front();
  EXPECT_EQ(result.cause, Cause::kUnsupported);
  EXPECT_THAT(result.reason, testing::HasSubstr("the device sends it by itself"));
}

constexpr auto kSilentMeter = R"(
summary: a meter
addresses: { from: 1, to: 1 }
areas: [{ name: telegram, record: true }]
operations:
  - name: telegram
    read: telegram
    unsolicited: 1s
    answer:
      - { name: begin, constant: "/" }
      - { name: serial, is: value, key: "S(", text: 4 }
      - { name: power, is: value, key: "P(", text: decimal(6) }
      - { name: end, constant: "!\r\n" }
)";

// Regression: the text of a value that a frame does not have was GOOD and empty.
TEST(Unsolicited, AValueThatAFrameDoesNotHaveIsNotAvailable) {
  const BusSetup setup{test::bus_by(
      "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0, baud: 9600 }\n"
      "    protocol: meter\n    devices:\n      - name: m\n        address: 1\n"
      "        channels:\n          - { name: s, at: serial, type: string(4), refresh: 3s }\n"
      "          - { name: p, at: power, type: float64, refresh: 3s }\n",
      "meter", kSilentMeter)};
  ChannelTable table(setup.spec());
  UnsolicitedListener listener(setup);
  listener.opened();
  const auto hear = [&](std::string_view text) {
    std::vector<Sample> samples;
    for (const auto& frame : listener.on_bytes(Bytes(text.begin(), text.end()), Instant{1s}))
      table.unsolicited(frame.device, frame.range, frame.items, frame.absent, Instant{1s}, samples);
    return samples;
  };
  EXPECT_TRUE(hear("/P(0001.0)!\r\n").empty()) << "its beginning may be missing";
  const auto whole = hear("/P(0001.5)S(1234)!\r\n");
  ASSERT_EQ(whole.size(), 2u);
  EXPECT_EQ(whole[0].value, Value{std::string("1234")});
  const auto without = hear("/P(0002.5)!\r\n");
  ASSERT_EQ(without.size(), 2u);
  EXPECT_EQ(without[0].quality, quality_of(Cause::kNotAvailable));
  EXPECT_EQ(without[0].device_code, kNotAvailableCode);
  EXPECT_EQ(without[0].value, Value{std::string("1234")}) << "the last good one";
  EXPECT_EQ(without[1].quality, Quality::kGood);
  EXPECT_EQ(without[1].value, Value{2.5});
}

TEST(Unsolicited, BytesWithoutAFrameAreDiscarded) {
  const BusSetup setup{test::bus_by(
      "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0, baud: 9600 }\n"
      "    protocol: meter\n    devices:\n      - name: m\n        address: 1\n"
      "        channels:\n          - { name: p, at: power, type: float64, refresh: 3s }\n",
      "meter", kSilentMeter)};
  UnsolicitedListener listener(setup);
  listener.opened();
  const auto frames = [&](std::string_view text) {
    return listener.on_bytes(Bytes(text.begin(), text.end()), Instant{1s}).size();
  };
  const std::string_view frame = "/P(0001.5)S(1234)!\r\n";
  for (const char noise : {'x', '/'}) {
    for (std::size_t bytes = 0; bytes < 2 * UnsolicitedListener::kMostKept; bytes += 1000)
      EXPECT_EQ(frames(std::string(1000, noise)), 0u);
    (void)frames(frame);  // its beginning may be missing
    EXPECT_EQ(frames(frame), 1u) << noise;
    EXPECT_EQ(frames(frame), 1u) << noise;
  }
}

// The rest of a frame never comes after a long pause: what follows is another frame.
TEST(Unsolicited, AFrameDoesNotGoOnAfterAPause) {
  const BusSetup setup{test::bus_by(
      "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0, baud: 9600 }\n"
      "    protocol: meter\n    devices:\n      - name: m\n        address: 1\n"
      "        channels:\n          - { name: p, at: power, type: float64, refresh: 3s }\n",
      "meter", kSilentMeter)};
  const std::string_view frame = "/P(0001.5)S(1234)!\r\n";
  for (const Duration pause : {Duration{500ms}, Duration{1500ms}}) {
    UnsolicitedListener listener(setup);
    listener.opened();
    const auto frames = [&](std::string_view text, Instant at) {
      return listener.on_bytes(Bytes(text.begin(), text.end()), at).size();
    };
    (void)frames(frame, Instant{1s});  // its beginning may be missing
    EXPECT_EQ(frames(frame, Instant{1100ms}), 1u);
    EXPECT_EQ(frames(frame.substr(0, 6), Instant{1200ms}), 0u);
    EXPECT_EQ(frames(frame.substr(6), Instant{1200ms} + pause), pause < 1s ? 1u : 0u);
  }
}

// Channels that a frame does not contain, or that no frame brings, keep their last sample.
TEST(Unsolicited, AFrameConcernsTheChannelsInItsRangeAlone) {
  BusSpec bus;
  DeviceSpec& device = bus.devices.emplace_back();
  for (const std::uint32_t first : {0u, 1u, 3u, 4u}) {
    ChannelSpec channel;
    channel.name = "c" + std::to_string(first);
    channel.range = {0, first, 1};
    channel.unsolicited = true;
    channel.refresh = 1s;
    if (first == 1) channel.calculation.value = std::make_shared<Calculation>();
    device.channels.push_back(channel);
  }
  ChannelTable table(bus);
  std::vector<Sample> out;
  const Range absent[] = {{0, 3, 1}};
  table.unsolicited(0, {0, 0, 4}, Bytes{0, 7, 0, 8, 0, 9, 0, 10}, absent, Instant{1s}, out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[0].channel, 0u);
  EXPECT_EQ(out[0].value, Value{std::uint64_t{7}});
  EXPECT_EQ(out[1].channel, 2u);
  EXPECT_EQ(out[1].quality, quality_of(Cause::kNotAvailable));
}

// A device that has sent nothing is silent, unless its port is known to be closed.
TEST(Unsolicited, ALateChannelHasTheCauseThatIsKnown) {
  for (const Cause cause : {Cause::kNone, Cause::kPortClosed}) {
    BusSpec bus;
    ChannelSpec channel;
    channel.unsolicited = true;
    channel.refresh = 1s;
    bus.devices.emplace_back().channels.push_back(channel);
    ChannelTable table(bus);
    std::vector<Sample> out;
    table.start(Instant{});
    if (cause != Cause::kNone) table.failing(0, cause, Instant{500ms});
    table.expire(Instant{2s}, out);
    EXPECT_EQ(out.size(), 1u);
    const CauseCounters misses = table.misses(Instant{2s});
    EXPECT_EQ(misses[Cause::kPortClosed], cause == Cause::kPortClosed ? 1u : 0u);
    EXPECT_EQ(misses[Cause::kNoResponse], cause == Cause::kNone ? 1u : 0u);
  }
}

// Requests, responses and unsolicited frames use one line; some of them collide.
TEST(Unsolicited, ADeviceIsPolledAndCommandedAsWell) {
  VirtualBus bus(line("      - name: a\n        address: 1\n        channels:\n"
                      "          - { name: w, at: weight, type: float64, refresh: 500ms }\n"
                      "          - { name: z, at: zero-band, type: uint16, refresh: 1s }\n"
                      "          - { name: t, at: tare, access: write-only }\n"),
                 {}, 1);
  bus.run_until(bus.now() + 2s);
  for (int i = 0; i < 20; ++i) {
    Command tare;
    tare.requester = "test";
    tare.device = "a";
    tare.target = ChannelTarget{"t"};
    tare.values = {Value{true}};
    bus.command(tare);
    bus.run_until(bus.now() + 500ms);
  }
  ASSERT_EQ(bus.results().size(), 20u);
  for (const auto& [id, results] : bus.results()) EXPECT_EQ(results.size(), 1u);
  EXPECT_GE(bus.channels()[0].good, 100u);
  EXPECT_GE(bus.channels()[1].good, 10u);
  EXPECT_EQ(bus.channels()[0].quality, Quality::kGood);
  EXPECT_EQ(bus.channels()[1].quality, Quality::kGood);
}

// Regression: a frame showed that the device was back, but did not resume its reads.
TEST(Unsolicited, ADeviceThatSendsAgainIsAlsoReadAgain) {
  sim::BusFaults faults;
  faults.devices["a"].silence = {{5s, 25s}};
  VirtualBus bus(line("      - name: a\n        address: 1\n        channels:\n"
                      "          - { name: w, at: weight, type: float64, refresh: 500ms }\n"
                      "          - { name: z, at: zero-band, type: uint16, refresh: 1s }\n"),
                 faults, 1);
  bus.run_until(bus.now() + 24500ms);
  EXPECT_EQ(bus.engine().device_report(0, bus.now()).state, DeviceState::kOffline);
  bus.run_until(bus.now() + 1500ms);
  EXPECT_EQ(bus.engine().device_report(0, bus.now()).state, DeviceState::kOnline);
  bus.watch_from_now();
  bus.run_until(bus.now() + 20s);
  EXPECT_GE(bus.channels()[1].good, 15u);
  EXPECT_EQ(bus.channels()[1].quality, Quality::kGood);
}

TEST(Unsolicited, NoWrongValueOnANoisyLine) {
  sim::BusFaults faults;
  faults.noise = 0.002;
  faults.babble = 3;
  for (const char* device : {"a", "b"}) {
    faults.devices[device].truncate = 0.05;
    faults.devices[device].doubled = 0.05;
    faults.devices[device].late_probability = 0.1;
    faults.devices[device].late = 40ms;
  }
  const BusSpec spec = two_scales();
  VirtualBus bus(spec, faults, 3);
  bus.judge = [](ChannelIndex, const Value& value) {
    const auto* number = std::get_if<double>(&value);
    return number != nullptr && *number >= 0 && *number <= 1000 ? "" : "wrong value";
  };
  bus.run_until(bus.now() + 120s);
  for (const auto& channel : bus.channels()) EXPECT_GE(channel.good, 200u);
}

}  // namespace
}  // namespace fieldcast
