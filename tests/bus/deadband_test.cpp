// What a deadband must not hold back.
#include <gtest/gtest.h>

#include "core/alarm/alarm_monitor.hpp"
#include "core/bus/command/channel_table.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

BusSpec one_channel(Encoding encoding, double deadband) {
  ChannelSpec channel;
  channel.name = "a";
  channel.encoding = encoding;
  channel.refresh = 1s;
  channel.deadband = deadband;
  channel.heartbeat = 24h;
  BusSpec bus;
  bus.devices.emplace_back();
  bus.devices.back().channels.push_back(channel);
  return bus;
}

// Reads a value each second, with the alarms of the published ones.
class Readings {
 public:
  explicit Readings(BusSpec bus) : bus_(std::move(bus)) {}

  // True if the value is published.
  bool read(std::uint16_t value) {
    return read({static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value)});
  }
  bool read(const Bytes& items) {
    now_ += 1s;
    std::vector<Sample> samples;
    table_.acquired(0, 16, items, now_, samples);
    std::vector<AlarmChange> changes;
    alarms_.on_samples(samples, now_, changes);
    for (const AlarmChange& change : changes) alarm_ = change.state == AlarmState::kActive;
    return !samples.empty();
  }
  void want(Duration refresh) { table_.set_refresh(0, refresh, now_); }
  [[nodiscard]] bool alarm() const { return alarm_; }

 private:
  BusSpec bus_;
  ChannelTable table_{bus_};
  AlarmMonitor alarms_{bus_};
  Instant now_{};
  bool alarm_ = false;
};

TEST(Deadband, AValueAcrossAHighLimitIsPublished) {
  BusSpec bus = one_channel({ValueType::kUint16}, 5);
  bus.devices[0].channels[0].limits = {.high = 80, .hysteresis = 2};
  Readings level(bus);
  EXPECT_TRUE(level.read(79));
  EXPECT_FALSE(level.read(80));
  EXPECT_TRUE(level.read(81));
  EXPECT_TRUE(level.alarm());
  EXPECT_FALSE(level.read(83));
  EXPECT_TRUE(level.read(79));
  EXPECT_TRUE(level.alarm()) << "not yet inside by the hysteresis";
  EXPECT_TRUE(level.read(78));
  EXPECT_FALSE(level.alarm());
  EXPECT_FALSE(level.read(74));
}

TEST(Deadband, AValueAcrossALowLimitIsPublished) {
  BusSpec bus = one_channel({ValueType::kInt16}, 5);
  bus.devices[0].channels[0].limits = {.low_low = 10, .hysteresis = 2};
  Readings level(bus);
  EXPECT_TRUE(level.read(11));
  EXPECT_FALSE(level.read(10));
  EXPECT_TRUE(level.read(9));
  EXPECT_TRUE(level.alarm());
  EXPECT_FALSE(level.read(8));
  EXPECT_TRUE(level.read(12));
  EXPECT_FALSE(level.alarm());
  EXPECT_FALSE(level.read(13));
}

TEST(Deadband, TheHysteresisOfEachLimitIsAnEdgeToo) {
  struct Row {
    Limits limits;
    std::uint16_t active, before, inside;  // `before`: one short of the value that ends the alarm
  };
  const Row rows[] = {
      {{.low_low = 100, .hysteresis = 2}, 99, 101, 102},
      {{.low = 100, .hysteresis = 2}, 99, 101, 102},
      {{.high = 100, .hysteresis = 2}, 101, 99, 98},
      {{.high_high = 100, .hysteresis = 2}, 101, 99, 98},
  };
  for (const Row& row : rows) {
    BusSpec bus = one_channel({ValueType::kUint16}, 5);
    bus.devices[0].channels[0].limits = row.limits;
    Readings level(bus);
    EXPECT_TRUE(level.read(row.before)) << "the first value";
    EXPECT_TRUE(level.read(row.active));
    EXPECT_TRUE(level.alarm());
    EXPECT_TRUE(level.read(row.before));
    EXPECT_TRUE(level.alarm());
    EXPECT_TRUE(level.read(row.inside));
    EXPECT_FALSE(level.alarm());
  }
}

TEST(Deadband, ATextIsHeldBackWhileItIsTheSame) {
  for (const double deadband : {0.0, 5.0}) {
    Readings state(one_channel({.type = ValueType::kString, .string_bytes = 2}, deadband));
    EXPECT_TRUE(state.read(*from_hex("4F4E")));
    EXPECT_FALSE(state.read(*from_hex("4F4E"))) << deadband;
    EXPECT_TRUE(state.read(*from_hex("4F46"))) << deadband;
  }
}

// Regression: the interest promises each of its refreshes to DDS, whatever the heartbeat.
TEST(Deadband, AChannelOnInterestIsPublishedAtEachRefresh) {
  BusSpec bus = one_channel({ValueType::kUint16}, 5);
  bus.devices[0].channels[0].on_interest = true;
  Readings level(bus);
  level.want(1s);
  EXPECT_TRUE(level.read(79));
  EXPECT_TRUE(level.read(79));
}

// Regression: both values are equal as doubles.
TEST(Deadband, ZeroPublishesEveryChangeOf64Bits) {
  Readings unsigned_word(one_channel({ValueType::kUint64}, 0));
  EXPECT_TRUE(unsigned_word.read(*from_hex("8000000000000000")));
  EXPECT_FALSE(unsigned_word.read(*from_hex("8000000000000000")));
  EXPECT_TRUE(unsigned_word.read(*from_hex("8000000000000001")));
  Readings signed_word(one_channel({ValueType::kInt64}, 0));
  EXPECT_TRUE(signed_word.read(*from_hex("C000000000000000")));
  EXPECT_TRUE(signed_word.read(*from_hex("C000000000000001")));
}

}  // namespace
}  // namespace fieldcast
