#include "core/bus/command/channel_table.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

ChannelSpec channel(const std::string& name, Duration refresh) {
  ChannelSpec spec;
  spec.name = name;
  spec.refresh = refresh;
  return spec;
}

BusSpec one_device(std::vector<ChannelSpec> channels) {
  BusSpec bus;
  bus.devices.emplace_back();
  bus.devices.back().channels = std::move(channels);
  return bus;
}

Bytes items(std::uint16_t value) {
  return {static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value)};
}

TEST(ChannelTable, EverySampleCarriesItsSequenceAndArrival) {
  const BusSpec bus = one_device({channel("a", 1s)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.acquired(0, 16, items(7), Instant{1s}, out);
  table.acquired(0, 16, items(7), Instant{2s}, out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[1].sequence, 2u);
  EXPECT_EQ(out[1].acquired, Instant{2s});
  EXPECT_EQ(out[1].quality, Quality::kGood);
  EXPECT_EQ(std::get<std::uint64_t>(out[1].value), 7u);
}

// Regression: a late response and the next one arrived together, and two samples had one time.
TEST(ChannelTable, OfResponsesThatArriveTogetherTheLaterHasALaterTime) {
  const BusSpec bus = one_device({channel("a", 1s)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  for (std::uint16_t value = 7; value < 10; ++value) {
    table.acquired(0, 16, items(value), Instant{1s}, out);
  }
  table.acquired(0, 16, items(10), Instant{2s}, out);
  ASSERT_EQ(out.size(), 4u);
  EXPECT_EQ(out[0].acquired, Instant{1s});
  EXPECT_EQ(out[1].acquired, Instant{1s + 1ns});
  EXPECT_EQ(out[2].acquired, Instant{1s + 2ns});
  EXPECT_EQ(out[3].acquired, Instant{2s});
}

// Regression: the text "+025.00" was read as the float 6.26e-13 with quality GOOD.
TEST(ChannelTable, TextThatSpellsNoNumberIsBadRangeAndKeepsTheLastValue) {
  BusSpec bus = one_device({channel("a", 1s)});
  bus.devices[0].channels[0].encoding = {.type = ValueType::kFloat32,
                                         .string_bytes = 7,
                                         .text_number = {.kind = TextNumber::Kind::kDecimal}};
  ChannelTable table(bus);
  const auto text = [](std::string characters) {
    characters.resize(8);
    return Bytes(characters.begin(), characters.end());
  };
  std::vector<Sample> out;
  table.acquired(0, 16, text("+025.00"), Instant{1s}, out);
  table.acquired(0, 16, text("-------"), Instant{2s}, out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[0].quality, Quality::kGood);
  EXPECT_EQ(out[0].value, Value{25.0});
  EXPECT_EQ(out[1].quality, Quality::kBadRange);
  EXPECT_EQ(out[1].value, Value{25.0});
  EXPECT_EQ(out[1].acquired, Instant{1s});
}

// Regression: a meter without a second direction published 42949672.95 kWh with quality GOOD.
TEST(ChannelTable, RawValueThatMeansNoValueIsBadRangeWithItsReason) {
  ChannelSpec energy = channel("a", 1s);
  energy.encoding = {.type = ValueType::kUint32, .scale = 0.01, .not_available = {0xFFFF'FFFF}};
  const BusSpec bus = one_device({energy});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.acquired(0, 16, *from_hex("00000064"), Instant{1s}, out);
  table.acquired(0, 16, *from_hex("FFFFFFFF"), Instant{2s}, out);
  table.acquired(0, 16, *from_hex("000000C8"), Instant{3s}, out);
  ASSERT_EQ(out.size(), 3u);
  EXPECT_EQ(out[0].quality, Quality::kGood);
  EXPECT_EQ(out[1].quality, Quality::kBadRange);
  EXPECT_EQ(out[1].device_code, kNotAvailableCode);
  EXPECT_EQ(out[1].value, Value{1.0}) << "the last good one";
  EXPECT_EQ(out[1].acquired, Instant{1s});
  EXPECT_EQ(out[2].quality, Quality::kGood);
  EXPECT_EQ(out[2].device_code, 0u);
}

TEST(ChannelTable, CodeOfNotAvailableEndsWithItsQuality) {
  ChannelSpec energy = channel("a", 1s);
  energy.encoding = {.type = ValueType::kUint16, .not_available = {0xFFFF}};
  const BusSpec bus = one_device({energy});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.start(Instant{});
  table.acquired(0, 16, items(0xFFFF), Instant{500ms}, out);
  table.failing(0, Cause::kNoResponse, Instant{600ms});
  out.clear();
  table.expire(Instant{5s}, out);
  ASSERT_FALSE(out.empty());
  EXPECT_EQ(out.back().quality, Quality::kBadNoResponse);
  EXPECT_EQ(out.back().device_code, 0u);
}

TEST(ChannelTable, MissedRefreshIsReportedOnceWithTheOldInstant) {
  const BusSpec bus = one_device({channel("a", 1s)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.start(Instant{});
  table.acquired(0, 16, items(7), Instant{500ms}, out);
  table.failing(0, Cause::kNoResponse, Instant{500ms});
  out.clear();
  table.expire(Instant{1502ms}, out);
  EXPECT_TRUE(out.empty());
  table.expire(Instant{1503ms}, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].quality, Quality::kBadNoResponse);
  EXPECT_EQ(out[0].acquired, Instant{500ms});
  EXPECT_EQ(std::get<std::uint64_t>(out[0].value), 7u);
  EXPECT_EQ(table.report(0, Instant{1503ms}).missed, 1u);
  table.expire(Instant{10s}, out);
  EXPECT_EQ(out.size(), 1u) << "told once";
  EXPECT_EQ(table.report(0, Instant{10s}).missed, 9u)
      << "and counted for every refresh that passes without a sample";
  EXPECT_EQ(table.misses(Instant{10s})[Cause::kNoResponse], 9u);
  table.acquired(0, 16, items(7), Instant{10s}, out);
  EXPECT_EQ(table.misses(Instant{10900ms}).total(), 9u);
}

TEST(ChannelTable, CauseThatIsKnownAfterTheMissIsReportedOnceMore) {
  const BusSpec bus = one_device({channel("a", 50ms)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.start(Instant{});
  table.acquired(0, 16, items(7), Instant{}, out);
  out.clear();
  table.expire(Instant{53ms}, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].quality, Quality::kUncertain);
  EXPECT_EQ(table.misses(Instant{53ms})[Cause::kLate], 1u);
  table.failing(0, Cause::kNoResponse, Instant{100ms});
  table.expire(Instant{100ms}, out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[1].quality, Quality::kBadNoResponse);
  EXPECT_EQ(table.misses(Instant{100ms})[Cause::kLate], 0u);
  EXPECT_EQ(table.misses(Instant{100ms})[Cause::kNoResponse], 1u) << "one refresh was missed";
  table.failing(0, Cause::kNoResponse, Instant{200ms});
  table.expire(Instant{200ms}, out);
  EXPECT_EQ(out.size(), 2u) << "told once";
}

TEST(ChannelTable, ChannelThatWasNeverReadIsLateToo) {
  const BusSpec bus = one_device({channel("a", 1s)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.start(Instant{});
  table.failing(0, Cause::kPortClosed, Instant{});
  table.expire(Instant{1003ms}, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].quality, Quality::kBadNoResponse);
  EXPECT_EQ(out[0].acquired, kLongAgo);
}

TEST(ChannelTable, ValueOutOfRangeKeepsTheLastGoodOne) {
  ChannelSpec bcd = channel("a", 1s);
  bcd.encoding.type = ValueType::kBcd16;
  const BusSpec bus = one_device({bcd});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.acquired(0, 16, items(0x1234), Instant{1s}, out);
  table.acquired(0, 16, items(0xABCD), Instant{2s}, out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[1].quality, Quality::kBadRange);
  EXPECT_EQ(to_text(out[1].value), "1234");
  EXPECT_EQ(out[1].acquired, Instant{1s}) << "a stale value never looks fresh";
}

TEST(ChannelTable, DeadbandHoldsBackAndTheHeartbeatIsKept) {
  ChannelSpec quiet = channel("a", 1s);
  quiet.deadband = 5;
  quiet.heartbeat = 4s;
  const BusSpec bus = one_device({quiet});
  ChannelTable table(bus);
  std::vector<Sample> out;
  Instant last{};
  for (int second = 0; second < 60; ++second) {
    const std::size_t before = out.size();
    table.acquired(0, 16, items(static_cast<std::uint16_t>(100 + second % 3)),
                   Instant{std::chrono::seconds{second}}, out);
    if (out.size() == before) continue;
    EXPECT_LE(Instant{std::chrono::seconds{second}} - last, 4s);
    last = Instant{std::chrono::seconds{second}};
  }
  EXPECT_LE(out.size(), 21u);
  EXPECT_GE(out.size(), 15u);
  const std::size_t before = out.size();
  table.acquired(0, 16, items(120), Instant{60s}, out);
  EXPECT_EQ(out.size(), before + 1) << "a change beyond the deadband goes out at once";
}

TEST(ChannelTable, OnDemandChannelsAreNeverLate) {
  ChannelSpec demand = channel("a", 1s);
  demand.mode = Mode::kOnDemand;
  const BusSpec bus = one_device({demand});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.start(Instant{});
  table.expire(Instant{100s}, out);
  EXPECT_EQ(table.misses(Instant{100s}).total(), 0u);
  table.not_yet_read(out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].quality, Quality::kNotYetRead);
}

// DDS declares one type for each channel, from its first sample on.
TEST(ChannelTable, AValueThatWasNeverReadHasTheTypeOfItsChannel) {
  struct Row {
    Encoding encoding;
    Value zero;
  };
  const std::vector<Row> rows{{{.type = ValueType::kBool}, false},
                              {{.type = ValueType::kUint16}, std::uint64_t{0}},
                              {{.type = ValueType::kInt8}, std::int64_t{0}},
                              {{.type = ValueType::kInt16}, std::int64_t{0}},
                              {{.type = ValueType::kInt32}, std::int64_t{0}},
                              {{.type = ValueType::kInt64}, std::int64_t{0}},
                              {{.type = ValueType::kInt16, .scale = 0.1}, 0.0},
                              {{.type = ValueType::kFloat32}, 0.0},
                              {{.type = ValueType::kFloat64}, 0.0},
                              {{.type = ValueType::kString, .string_bytes = 4}, std::string{}}};
  std::vector<ChannelSpec> channels;
  for (const Row& row : rows) {
    channels.push_back(channel("c" + std::to_string(channels.size()), 0s));
    channels.back().encoding = row.encoding;
    channels.back().mode = Mode::kOnDemand;
  }
  const BusSpec bus = one_device(channels);
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.not_yet_read(out);
  ASSERT_EQ(out.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(out[i].value, rows[i].zero) << i;
}

TEST(ChannelTable, WhatWasNeverReadIsNotYetReadHoweverLateItIs) {
  const BusSpec bus = one_device({channel("slow", 1s), channel("dead", 1s), channel("leased", 1s)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.start(Instant{});
  table.failing(1, Cause::kNoResponse, Instant{500ms});
  table.failing(2, Cause::kLeased, Instant{500ms});
  table.expire(Instant{2s}, out);
  ASSERT_EQ(out.size(), 3u);
  for (const Sample& sample : out) {
    EXPECT_EQ(sample.quality, sample.channel == 1 ? Quality::kBadNoResponse : Quality::kNotYetRead);
    EXPECT_EQ(sample.acquired, kLongAgo);
  }
  out.clear();
  table.failing(0, Cause::kNoResponse, Instant{3s});
  table.expire(Instant{3s}, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].quality, Quality::kBadNoResponse);
}

TEST(ChannelTable, AChannelThatWasReadDoesNotWakeTheBusAtItsFormerTime) {
  const BusSpec bus = one_device({channel("a", 1s), channel("b", 10s)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.start(Instant{});
  const Instant first = table.next_expiry();
  table.acquired(0, 16, items(7), Instant{900ms}, out);
  table.acquired(1, 16, items(7), Instant{900ms}, out);
  out.clear();
  table.expire(Instant{900ms}, out);
  EXPECT_GE(table.next_expiry(), first + 900ms);
  EXPECT_LT(table.next_expiry(), first + 2s);
  table.expire(table.next_expiry(), out);
  EXPECT_EQ(out.size(), 1u);
}

TEST(ChannelTable, ShorterRefreshTakesEffectImmediately) {
  ChannelSpec asked_for = channel("a", 10s);
  asked_for.on_interest = true;
  const BusSpec bus = one_device({asked_for});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.set_refresh(0, 10s, Instant{});
  table.set_refresh(0, 200ms, Instant{1s});
  EXPECT_EQ(table.next_expiry(), Instant{1203ms});
  table.expire(Instant{1203ms}, out);
  EXPECT_EQ(out.size(), 1u);
  table.set_refresh(0, std::nullopt, Instant{2s});
  table.expire(Instant{100s}, out);
  EXPECT_EQ(out.size(), 1u);
  EXPECT_EQ(table.misses(Instant{100s}).total(), 4u) << "until the interest in it ended";
}

TEST(ChannelTable, RefusedChannelIsReportedImmediatelyAndOnce) {
  const BusSpec bus = one_device({channel("a", 1s)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.start(Instant{});
  table.refused(0, Cause::kDeviceError, 2, Instant{100ms}, out);
  table.refused(0, Cause::kDeviceError, 2, Instant{60s}, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].quality, Quality::kBadDeviceError);
  EXPECT_EQ(out[0].device_code, 2);
  table.expire(Instant{100s}, out);
  EXPECT_EQ(out.size(), 1u);
}

TEST(ChannelTable, AValueWithoutInterestDoesNotLookFresh) {
  BusSpec bus = one_device({channel("a", 1s)});
  bus.devices[0].channels[0].on_interest = true;
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.interest_ended(0, out);
  EXPECT_TRUE(out.empty()) << "never read: nothing to take back";
  table.set_refresh(0, 1s, Instant{});
  table.acquired(0, 16, items(7), Instant{500ms}, out);
  ASSERT_EQ(out.size(), 1u);
  table.interest_ended(0, out);
  table.set_refresh(0, std::nullopt, Instant{600ms});
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[1].quality, Quality::kUncertain);
  EXPECT_EQ(out[1].value, out[0].value);
  EXPECT_EQ(out[1].acquired, Instant{500ms});
  table.interest_ended(0, out);
  EXPECT_EQ(out.size(), 2u) << "said once";
  table.set_refresh(0, 1s, Instant{2s});
  table.acquired(0, 16, items(7), Instant{2100ms}, out);
  ASSERT_EQ(out.size(), 3u);
  EXPECT_EQ(out[2].quality, Quality::kGood);
}

// A late sample counts as a miss even if no miss was published before: stations see the gap.
TEST(ChannelTable, ASampleThatComesJustTooLateIsAMiss) {
  const BusSpec bus = one_device({channel("a", 1s)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.start(Instant{});
  table.acquired(0, 16, items(7), Instant{1s}, out);
  EXPECT_EQ(table.misses(Instant{1s}).total(), 0u);
  table.acquired(0, 16, items(7), Instant{2001ms}, out);
  EXPECT_EQ(table.misses(Instant{2001ms})[Cause::kLate], 1u);
  EXPECT_EQ(table.report(0, Instant{2001ms}).last_miss, Cause::kLate);
}

TEST(ChannelTable, SequencesGoOnWhereAnotherBridgeWas) {
  const BusSpec bus = one_device({channel("a", 1s)});
  ChannelTable table(bus);
  Sample last;
  last.value = std::uint64_t{7};
  last.quality = Quality::kGood;
  last.acquired = Instant{1s};
  last.sequence = 41;
  table.inherit(last);
  table.start(Instant{2s});
  std::vector<Sample> out;
  table.expire(Instant{5s}, out);
  ASSERT_EQ(out.size(), 1u) << "nobody answers: the last value once more";
  EXPECT_EQ(out[0].sequence, 42u);
  EXPECT_EQ(out[0].value, last.value);
  EXPECT_NE(out[0].quality, Quality::kGood);
  table.acquired(0, 16, items(8), Instant{6s}, out);
  EXPECT_EQ(out.back().sequence, 43u);
}

// The other bridge had another configuration: one channel of another type, and one more.
TEST(ChannelTable, OfAnInheritedValueOfAnotherTypeOnlyTheSequenceGoesOn) {
  const BusSpec bus = one_device({channel("a", 1s)});
  ChannelTable table(bus);
  Sample last{.channel = 1, .value = std::string("on"), .quality = Quality::kGood};
  last.sequence = 41;
  table.inherit(last);
  last.channel = 0;
  table.inherit(last);
  EXPECT_FALSE(table.was_read(0));
  table.start(Instant{});
  std::vector<Sample> out;
  table.expire(Instant{5s}, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].sequence, 42u);
  EXPECT_EQ(out[0].value, Value{std::uint64_t{0}});
  EXPECT_EQ(out[0].quality, Quality::kNotYetRead);
}

TEST(ChannelTable, ARefusalWithAnotherCodeIsReportedToo) {
  const BusSpec bus = one_device({channel("a", 1s)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  for (const std::uint16_t code : {std::uint16_t{2}, std::uint16_t{2}, std::uint16_t{4}}) {
    table.refused(0, Cause::kDeviceError, code, Instant{1s}, out);
  }
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[1].device_code, 4);
}

// This also holds for channels of which this bridge has received no sample.
TEST(ChannelTable, CountsOnAboveWhatASecondMasterMayHavePublished) {
  ChannelSpec on_demand = channel("b", 1s);
  on_demand.mode = Mode::kOnDemand;
  const BusSpec bus = one_device({channel("a", 1s), on_demand, channel("c", 1s)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.acquired(0, 16, items(7), Instant{1s}, out);
  table.acquired(1, 16, items(8), Instant{1s}, out);
  out.clear();
  table.count_above(1000);
  table.again(out);
  EXPECT_TRUE(out.empty()) << "another one may have read later what is good";
  for (ChannelIndex each : {0u, 1u, 2u}) table.acquired(each, 16, items(9), Instant{2s}, out);
  ASSERT_EQ(out.size(), 3u);
  for (const Sample& sample : out) EXPECT_EQ(sample.sequence, 1001u);
  table.count_above(500);  // the count never decreases
  table.acquired(0, 16, items(9), Instant{3s}, out);
  EXPECT_EQ(out.back().sequence, 1002u);
}

// A station may still show a good value of another bridge.
TEST(ChannelTable, WhatIsNotGoodIsReportedAgainAndTheNextReadingWhateverTheDeadband) {
  ChannelSpec spec = channel("a", 1s);
  spec.deadband = 5;
  spec.heartbeat = 1h;
  const BusSpec bus = one_device({spec, channel("b", 1s)});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.start(Instant{});
  table.acquired(0, 16, items(7), Instant{1s}, out);
  table.refused(1, Cause::kDeviceError, 2, Instant{1s}, out);
  out.clear();
  table.acquired(0, 16, items(8), Instant{1100ms}, out);
  EXPECT_TRUE(out.empty()) << "within the deadband";
  table.again(out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].channel, 1u);
  EXPECT_EQ(out[0].quality, Quality::kBadDeviceError);
  table.acquired(0, 16, items(8), Instant{1200ms}, out);
  EXPECT_EQ(out.size(), 2u);
}

// Regression: a value that a command had read stayed GOOD for ever.
TEST(ChannelTable, AValueReadByCommandWithoutAnInterestIsUncertain) {
  ChannelSpec spec = channel("a", 1s);
  spec.on_interest = true;
  const BusSpec bus = one_device({spec});
  ChannelTable table(bus);
  std::vector<Sample> out;
  table.acquired(0, 16, items(7), Instant{1s}, out);
  table.set_refresh(0, 1s, Instant{2s});
  table.acquired(0, 16, items(7), Instant{3s}, out);
  table.set_refresh(0, std::nullopt, Instant{4s});
  table.acquired(0, 16, items(7), Instant{5s}, out);
  ASSERT_EQ(out.size(), 3u);
  EXPECT_EQ(out[0].quality, Quality::kUncertain);
  EXPECT_EQ(out[0].acquired, Instant{1s});
  EXPECT_EQ(out[1].quality, Quality::kGood);
  EXPECT_EQ(out[2].quality, Quality::kUncertain);
}

}  // namespace
}  // namespace fieldcast
