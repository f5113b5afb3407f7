#include "tools/sim/bus/sim_bus.hpp"

#include <gtest/gtest.h>

#include "core/codec/checksum.hpp"

namespace fieldcast::sim {
namespace {

using namespace std::chrono_literals;
constexpr Instant kBegin{100s};
constexpr LineFormat kLine{115200, 8, Parity::kNone, 1};

Bytes rtu(Bytes frame) {
  const std::uint16_t crc = crc16_modbus(frame);
  frame.push_back(static_cast<std::uint8_t>(crc));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}

BusSpec two_presses() {
  BusSpec bus;
  bus.name = "shop";
  SerialPortSpec port;
  port.line = kLine;
  bus.port = port;
  for (const std::uint16_t unit : {std::uint16_t{1}, std::uint16_t{2}}) {
    DeviceSpec device;
    device.name = "press-" + std::to_string(unit);
    device.protocol = "modbus-rtu";
    device.link.address = unit;
    ChannelSpec channel;
    channel.name = "level";
    channel.at = "holding:0";
    device.channels.push_back(channel);
    bus.devices.push_back(device);
  }
  return bus;
}

struct Master {
  explicit Master(const BusFaults& faults = {}, const BusSpec& spec = two_presses())
      : bus(std::move(SimBus::make(spec, faults, 1, kBegin).value())), line(bus->open_line()) {}

  // Returns the bytes that arrived until `patience` after the request.
  Bytes ask(const Bytes& request, Duration patience = 200ms) {
    line->receive(request, now);
    const Instant until = now + patience;
    Bytes answer;
    while (line->next_due() <= until) {
      now = line->next_due();
      const std::size_t before = answer.size();
      line->advance(now, answer);
      if (answer.size() > before) last_byte = now;
    }
    now = until;
    return answer;
  }

  std::unique_ptr<SimBus> bus;
  std::unique_ptr<BusLine> line;
  Instant now = kBegin + 1s, last_byte = kLongAgo;
};

const Bytes kRead1 = rtu({1, 3, 0, 0, 0, 10});
const Bytes kRead2 = rtu({2, 3, 0, 0, 0, 10});

TEST(SimBus, ResponseEndsAfterRequestDelayAndResponse) {
  Master master;
  const Instant sent = master.now;
  EXPECT_EQ(master.ask(kRead1).size(), 25u);
  const Duration character = kLine.characters(1);
  EXPECT_EQ(master.last_byte - sent, 8 * character + 2ms + 25 * character);
}

TEST(SimBus, SlavesLeaveEachOthersTrafficAlone) {
  Master master;
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(master.ask(kRead1, 10ms).at(0), 1);
    EXPECT_EQ(master.ask(kRead2, 10ms).at(0), 2);
  }
  for (const SimBus::Member& member : master.bus->members()) {
    EXPECT_EQ(member.device->statistics().requests.at("03"), 20u);
    EXPECT_EQ(member.device->statistics().bad_frames, 0u);
  }
  EXPECT_EQ(master.bus->statistics().collisions, 0u);
}

TEST(SimBus, ADeadDeviceNeitherReceivesNorRespondsUntilItComesBack) {
  BusFaults faults;
  faults.devices["press-1"].silence = {{0s, 5s}};
  Master master(faults);
  const Bytes write = rtu({1, 6, 0, 0, 0, 9});
  EXPECT_TRUE(master.ask(write).empty());
  EXPECT_TRUE(master.bus->members()[0].device->statistics().writes.empty());
  EXPECT_FALSE(master.ask(kRead2).empty());
  master.now = kBegin + 5s;
  EXPECT_EQ(master.ask(write), write);
}

TEST(SimBus, LostResponsesWereExecutedAnyway) {
  BusFaults faults;
  faults.devices["press-1"].loss = 1;
  Master master(faults);
  EXPECT_TRUE(master.ask(rtu({1, 6, 0, 0, 0, 9})).empty());
  EXPECT_EQ(master.bus->members()[0].device->statistics().writes.at("holding:0"), 1u);
  EXPECT_EQ(master.bus->members()[0].spoiled, 1u);
}

TEST(SimBus, ALateResponseArrivesLateAndItsDeviceIsDeafUntilThen) {
  BusFaults faults;
  faults.devices["press-1"].late_probability = 1;
  faults.devices["press-1"].late = 300ms;
  Master master(faults);
  EXPECT_TRUE(master.ask(kRead1, 200ms).empty());
  EXPECT_EQ(master.ask(kRead1, 200ms).size(), 25u);  // the response to the first request
  EXPECT_EQ(master.bus->members()[0].device->statistics().requests.at("03"), 1u);
}

TEST(SimBus, GarbledAndTruncatedResponsesDiffer) {
  BusFaults faults;
  faults.devices["press-1"].garble = 1;
  faults.devices["press-2"].truncate = 1;
  Master master(faults);
  const Bytes garbled = master.ask(rtu({1, 6, 0, 0, 0, 9}));
  EXPECT_EQ(garbled.size(), 8u);
  EXPECT_NE(garbled, rtu({1, 6, 0, 0, 0, 9}));
  EXPECT_LT(master.ask(kRead2).size(), 25u);
}

TEST(SimBus, RefusedRangesRespondWithTheirCode) {
  BusFaults faults;
  faults.devices["press-1"].refused = {{"holding", 5, 5, 2}};
  Master master(faults);
  EXPECT_EQ(master.ask(kRead1), rtu({1, 0x83, 2}));
  EXPECT_EQ(master.bus->members()[0].device->statistics().exceptions.at(2), 1u);
}

TEST(SimBus, NoiseIsTheSameForTheSameSeed) {
  BusFaults faults;
  faults.noise = 1e-3;
  const auto day = [&] {
    Master master(faults);
    Bytes all;
    for (int i = 0; i < 50; ++i) append(all, master.ask(kRead1, 20ms));
    return all;
  };
  const Bytes one = day();
  EXPECT_EQ(one, day());
  EXPECT_LT(one.size(), 50u * 25u);  // some requests were garbled
}

TEST(SimBus, EchoPrecedesTheResponse) {
  BusFaults faults;
  faults.echo = true;
  Master master(faults);
  const Bytes received = master.ask(kRead1);
  ASSERT_EQ(received.size(), 33u);
  EXPECT_TRUE(std::equal(kRead1.begin(), kRead1.end(), received.begin()));
}

TEST(SimBus, BabbleComesWithoutARequest) {
  BusFaults faults;
  faults.babble = 10;
  Master master(faults);
  EXPECT_GT(master.ask(kRead2, 5s).size(), 25u);
}

TEST(SimBus, AMasterThatTalksIntoTheResponseSpoilsIt) {
  Master master;
  Bytes answer;
  master.line->receive(kRead1, master.now);
  master.line->advance(master.now + 3ms, answer);
  master.line->receive(kRead2, master.now + 3ms);
  while (master.line->next_due() != kNever) master.line->advance(master.line->next_due(), answer);
  EXPECT_GT(master.bus->statistics().collisions, 0u);
  EXPECT_NE(crc16_modbus(ByteView(answer).first(answer.size() - 2)),
            answer[answer.size() - 2] | answer.back() << 8);
}

TEST(SimBus, PipelinedTcpRequestsGetResponsesInOrder) {
  BusSpec spec = two_presses();
  spec.port = TcpPortSpec{"127.0.0.1", 1502, std::nullopt};
  spec.devices.resize(1);
  spec.devices[0].protocol = "modbus-tcp";
  Master master({}, spec);
  const auto request = [](std::uint8_t id) { return Bytes{0, id, 0, 0, 0, 6, 1, 3, 0, 0, 0, 1}; };
  Bytes both = request(1);
  append(both, request(2));
  const Bytes answers = master.ask(both);
  ASSERT_EQ(answers.size(), 22u);
  EXPECT_EQ(answers[1], 1);
  EXPECT_EQ(answers[12], 2);
}

TEST(SimBus, RefusesWhatItCannotSimulate) {
  BusSpec spec = two_presses();
  spec.devices[1].protocol = "profibus";
  const auto bus = SimBus::make(spec, {}, 1, kBegin);
  ASSERT_FALSE(bus);
  EXPECT_NE(bus.error().find("shop/press-2"), std::string::npos);
  spec = two_presses();
  spec.devices[0].channels[0].at = "DM100";
  EXPECT_FALSE(SimBus::make(spec, {}, 1, kBegin));
}

TEST(SimBus, RandomBytesDoNoHarm) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Master master;
    std::mt19937_64 random(seed);
    for (int i = 0; i < 100; ++i) {
      Bytes noise(random() % 300);
      for (std::uint8_t& byte : noise)
        byte = static_cast<std::uint8_t>(random() % 8 == 0 ? random() : random() % 4);
      [[maybe_unused]] const Bytes answer = master.ask(noise, 100ms);
    }
    EXPECT_EQ(master.ask(kRead1).size(), 25u);
  }
}

}  // namespace
}  // namespace fieldcast::sim
