#include "tools/forward/payload/codec.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "schema/forward.pb.h"
#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/payload/compression.hpp"

namespace fieldcast::forward {
namespace {

// With the names, which the payload does not carry.
SampleBatch round_trip(const SampleBatch& batch) {
  auto decoded = decode_samples(encode(batch));
  EXPECT_TRUE(decoded);
  if (!decoded) return {};
  decoded->bus = batch.bus;
  decoded->device = batch.device;
  return *decoded;
}

TEST(SampleCodec, EveryKindOfValueIsRestored) {
  SampleBatch batch{"line", "press", 7, 0xFFFFFFFFFFFFFFFF, {}};
  const std::vector<Value> values{true,
                                  false,
                                  std::int64_t{-5},
                                  std::numeric_limits<std::int64_t>::min(),
                                  std::numeric_limits<std::uint64_t>::max(),
                                  0.1,
                                  0.5,
                                  std::numeric_limits<double>::infinity(),
                                  std::string("über"),
                                  std::string("\xE4\0x", 3),
                                  std::string()};
  for (std::size_t i = 0; i < values.size(); ++i)
    batch.samples.push_back({.channel = static_cast<std::uint32_t>(3 * i),
                             .sequence = 100 + i,
                             .acquired_at = {1'764'360'000'000'000'000},
                             .value = values[i]});
  EXPECT_EQ(round_trip(batch), batch);
}

TEST(SampleCodec, SequencesAndTimesMayJumpInBothDirections) {
  SampleBatch batch{"line", "press", 7, 1, {}};
  for (const std::uint64_t sequence :
       {std::numeric_limits<std::uint64_t>::max(), std::uint64_t{1}, std::uint64_t{1} << 63})
    batch.samples.push_back({.sequence = sequence,
                             .acquired_at = {static_cast<std::int64_t>(sequence)},
                             .value = true});
  EXPECT_EQ(round_trip(batch), batch);
}

TEST(SampleCodec, QualitiesAreRestored) {
  SampleBatch batch = seconds(0, 6);
  batch.samples[1].quality = Quality::kBadNoResponse;
  batch.samples[4].quality = Quality::kBadDeviceError;
  batch.samples[4].device_code = 65535;
  EXPECT_EQ(round_trip(batch), batch);
}

TEST(SampleCodec, AnEmptyBatchIsRestored) { EXPECT_EQ(round_trip(seconds(0, 0)), seconds(0, 0)); }

TEST(SampleCodec, ASampleOfAnExchangeNeedsFewBytes) {
  SampleBatch batch{"line", "press", 7, 1, {}};
  for (std::uint32_t i = 0; i < 100; ++i)
    batch.samples.push_back({.channel = i,
                             .sequence = 4711,
                             .acquired_at = {1'764'360'000'000'000'000},
                             .value = 20.5});
  EXPECT_LT(encode(batch).size(), 100 * 7u);
}

TEST(SampleCodec, ColumnsThatDoNotMatchAreRejected) {
  const auto broken = [](auto change) {
    v1::SampleBatch message;
    EXPECT_TRUE(message.ParseFromString(encode(seconds(0, 3))));
    change(message);
    return !decode_samples(message.SerializeAsString());
  };
  EXPECT_FALSE(broken([](v1::SampleBatch&) {}));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.set_schema(2); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.add_sequences(1); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.clear_acquired_at(); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.clear_instants(); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.set_acquired_at(0, -1); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.set_acquired_at(2, 2'000'000'000); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.clear_singles(); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.clear_kinds(); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.set_kinds(0, 9); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.add_channels(1); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.set_channels(1, 2); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.add_counts(0); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.set_counts(0, 4'000'000'000); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) { m.add_qualities(1); }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) {
    for (const std::uint32_t item : {3u, 1u, 0u}) m.add_qualities(item);
  }));
  EXPECT_TRUE(broken([](v1::SampleBatch& m) {
    for (const std::uint32_t item : {0u, 99u, 0u}) m.add_qualities(item);
  }));
}

TEST(SampleCodec, EveryTruncationIsRejectedOrShorter) {
  const std::string text = encode(seconds(0, 20));
  for (std::size_t size = 0; size < text.size(); ++size) {
    const auto decoded = decode_samples(std::string_view(text).substr(0, size));
    EXPECT_TRUE(!decoded || decoded->samples.size() < 20) << size;
  }
}

TEST(CatalogueCodec, EveryFieldIsRestored) {
  DeviceCatalogue made = catalogue({"a", "b"});
  made.channels[0].bridge.clear();
  made.channels[1].bridge.clear();
  made.channels[1].access = Access::kReadWrite;
  made.channels[1].mode = Mode::kOnDemand;
  made.channels[1].description = "oil";
  made.channels[1].limits.low = -1.5;
  made.channels[1].limits.high_high = 100;
  made.channels[1].write_min = 0;
  made.channels[1].write_max = 50;
  const auto decoded = decode_catalogue(encode("north", made));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(*decoded, made);
  EXPECT_EQ(identity_of(*decoded), identity_of(made));
}

TEST(AlarmCodec, EveryFieldIsRestored) {
  const auto decoded = decode_alarm(encode("north", alarm()));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->alarm, alarm().alarm);
  EXPECT_EQ(decoded->status, alarm().status);
}

TEST(AuditCodec, ATextThatIsNotUtf8IsEscaped) {
  AuditReport made = audit();
  made.who = "panel\xC3";
  made.what = "write \xFF";
  made.target = "line/press at \xE4";
  made.result = "rejected: \x80";
  const auto decoded = decode_audit(encode("north", made));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->who, "panel\\xC3");
  EXPECT_EQ(decoded->what, "write \\xFF");
  EXPECT_EQ(decoded->target, "line/press at \\xE4");
  EXPECT_EQ(decoded->result, "rejected: \\x80");
}

TEST(Compression, ShortensARepetitiveTextAndKeepsAShortOne) {
  const std::string frame = compressed(std::string(1000, 'x'));
  EXPECT_LT(frame.size(), 100u);
  EXPECT_EQ(frame.substr(0, 4), "\x28\xB5\x2F\xFD");
  EXPECT_EQ(compressed("x"), "x");
}

TEST(AuditCodec, EveryFieldComesBack) {
  const auto back = decode_audit(encode("north", audit()));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->bridge, "plant");
  EXPECT_EQ(back->epoch, 7u);
  EXPECT_EQ(back->number, 3u);
  EXPECT_EQ(back->at, audit().at);
  EXPECT_EQ(back->who, "fieldcast/anna");
  EXPECT_EQ(back->what, "write 21.5");
  EXPECT_EQ(back->target, "line/press/setpoint");
  EXPECT_EQ(back->bytes_to_device, 8u);
  EXPECT_EQ(back->bytes_from_device, 9u);
  EXPECT_EQ(back->result, "done");
  EXPECT_FALSE(decode_audit("x"));
  EXPECT_FALSE(decode_audit(""));
}

TEST(AuditCodec, TheIdentityIsThatOfTheNumber) {
  AuditReport next = audit();
  EXPECT_EQ(identity_of(next), identity_of(audit()));
  ++next.number;
  EXPECT_NE(identity_of(next), identity_of(audit()));
}

}  // namespace
}  // namespace fieldcast::forward
