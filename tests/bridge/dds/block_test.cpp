#include "bridge/dds/topics/block.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/sample_type.hpp"
#include "bridge/dds/topics/topic_type.hpp"

namespace fieldcast {
namespace {

const UtcMapping kClocks{Instant{std::chrono::seconds{100}}, {1'000'000'000'000'000'000}};

Sample sample_of(Value value, std::uint64_t sequence = 1) {
  Sample sample;
  sample.value = std::move(value);
  sample.quality = Quality::kGood;
  sample.acquired = kClocks.instant;
  sample.sequence = sequence;
  return sample;
}

LastValue last(Value value, std::uint64_t sequence = 1) {
  LastValue out;
  to_last_value(sample_of(std::move(value), sequence), kClocks, out);
  return out;
}

const std::vector<Value> kEveryKind{true,
                                    false,
                                    std::int64_t{-5},
                                    std::numeric_limits<std::int64_t>::min(),
                                    std::uint64_t{7},
                                    std::numeric_limits<std::uint64_t>::max(),
                                    -0.125,
                                    std::string(),
                                    std::string("Grüße"),
                                    std::string(256, 'x')};

TEST(SampleBlock, EveryKindOfValueComesBack) {
  idl::SampleBlock block;
  BlockFiller filler(block, 32'000);
  for (std::size_t i = 0; i < kEveryKind.size(); ++i)
    ASSERT_TRUE(filler.add(static_cast<ChannelIndex>(2 * i), last(kEveryKind[i], i + 1)));
  filler.finish();
  ASSERT_TRUE(is_whole(block));
  ASSERT_EQ(block.channels().size(), kEveryKind.size());
  for (std::size_t i = 0; i < kEveryKind.size(); ++i) {
    StationSample out;
    ASSERT_TRUE(read_row(block, i, out));
    EXPECT_EQ(block.channels()[i], 2 * i);
    EXPECT_EQ(out.value, kEveryKind[i]);
    EXPECT_EQ(out.quality, Quality::kGood);
    EXPECT_EQ(out.sequence, i + 1);
    EXPECT_EQ(out.acquired_at.nanoseconds, kClocks.utc.nanoseconds);
  }
}

TEST(SampleBlock, ColumnsThatAreTheSameInEveryRowShrink) {
  idl::SampleBlock block;
  BlockFiller filler(block, 32'000);
  for (ChannelIndex i = 0; i < 3; ++i) ASSERT_TRUE(filler.add(i, last(1.5)));
  filler.finish();
  EXPECT_TRUE(block.device_codes().empty());
  EXPECT_EQ(block.acquired_at().size(), 1u);

  BlockFiller again(block, 32'000);
  LastValue other = last(2.5);
  other.device_code = 9;
  other.acquired_at += 1;
  ASSERT_TRUE(again.add(0, last(1.5)) && again.add(1, other));
  again.finish();
  StationSample out;
  ASSERT_TRUE(is_whole(block) && read_row(block, 1, out));
  EXPECT_EQ(out.device_code, 9);
  EXPECT_EQ(out.acquired_at.nanoseconds, other.acquired_at);
}

TEST(SampleBlock, KeepsItsSizeOnTheWire) {
  TopicType<idl::SampleBlockPubSubType> type;
  for (const std::size_t most : {1'300u, 32'000u}) {
    for (const Value& value : kEveryKind) {
      idl::SampleBlock block;
      block.bus() = std::string(kMaxNameLength, 'b');
      BlockFiller filler(block, most);
      for (ChannelIndex i = 0; filler.add(i, last(value)); ++i) {}
      EXPECT_LE(type.size_of(&block) - kEncapsulationBytes, most);
      EXPECT_GT(block.channels().size(), 2u);
      EXPECT_LE(block.channels().size(), BlockFiller::kMaxRows);
    }
  }
}

// The generated code would allocate memory for all before it reads one.
TEST(SampleBlock, MoreTextsThanItMayHaveAreRefusedBeforeMemoryIsTaken) {
  constexpr std::uint32_t kTexts = 4'000'000;  // would need a gigabyte
  idl::SampleBlock block;
  block.bus() = "line";
  TopicType<idl::SampleBlockPubSubType> type;
  rtps::SerializedPayload_t payload(1024);
  ASSERT_TRUE(type.to_bytes(&block, payload));
  std::memcpy(payload.data + payload.length - sizeof kTexts, &kTexts, sizeof kTexts);
  EXPECT_FALSE(type.from_bytes(payload, &block));
  EXPECT_LT(block.texts().capacity(), 10'000U);
}

TEST(SampleBlock, WhatDoesNotFitTogetherIsRefused) {
  idl::SampleBlock block;
  BlockFiller filler(block, 32'000);
  for (ChannelIndex i = 0; i < 3; ++i) ASSERT_TRUE(filler.add(i, last(std::string("x"))));
  filler.finish();
  const auto broken = [&](auto change) {
    idl::SampleBlock copy = block;
    change(copy);
    return copy;
  };
  EXPECT_FALSE(is_whole(broken([](auto& b) { b.kinds().pop_back(); })));
  EXPECT_FALSE(is_whole(broken([](auto& b) { b.values().push_back(0); })));
  EXPECT_FALSE(is_whole(broken([](auto& b) { b.acquired_at().clear(); })));
  EXPECT_FALSE(is_whole(broken([](auto& b) { b.device_codes().push_back(1); })));
  EXPECT_FALSE(is_whole(broken([](auto& b) { b.sequences().clear(); })));
  StationSample out;
  EXPECT_FALSE(read_row(broken([](auto& b) { b.kinds()[0] = 77; }), 0, out));
  EXPECT_FALSE(read_row(broken([](auto& b) { b.qualities()[0] = 77; }), 0, out));
  EXPECT_FALSE(read_row(broken([](auto& b) { b.values()[0] = 3; }), 0, out)) << "no such text";
}

TEST(SampleBlock, ATextThatDoesNotFitIsEmptyAndBad) {
  const LastValue value = last(std::string(257, 'x'));
  EXPECT_EQ(value.text, "");
  EXPECT_EQ(value.quality, idl::Quality::BAD_RANGE);
}

TEST(SampleType, WritesTheBytesOfTheGeneratedType) {
  for (const std::string& name : {std::string("b"), std::string("bus-12"), std::string(64, 'n')}) {
    const SampleKey key(name, "device", name);
    for (const Value& value : kEveryKind) {
      idl::Sample generated;
      generated.bus() = name;
      generated.device() = "device";
      generated.channel() = name;
      to_idl(sample_of(value), kClocks, generated);
      TopicType<idl::SamplePubSubType> plain;
      rtps::SerializedPayload_t expected(1024), written(1024);
      ASSERT_TRUE(plain.to_bytes(&generated, expected));
      rtps::InstanceHandle_t handle, ours;
      plain.key_of(&generated, handle, false);

      SampleType type;
      const LastValue value_of_it = last(value);
      OutgoingSample outgoing{&key, &value_of_it};
      EXPECT_GE(type.size_of(&outgoing), expected.length);
      ASSERT_TRUE(type.to_bytes(&outgoing, written));
      ASSERT_TRUE(type.key_of(&outgoing, ours, false));
      EXPECT_EQ(ours, handle);
      ASSERT_EQ(written.length, expected.length);
      EXPECT_EQ(std::string(reinterpret_cast<char*>(written.data), written.length),
                std::string(reinterpret_cast<char*>(expected.data), expected.length));
    }
  }
}

}  // namespace
}  // namespace fieldcast
