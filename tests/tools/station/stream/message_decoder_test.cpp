#include "tools/station/stream/message_decoder.hpp"

#include <gtest/gtest.h>

#include "tests/tools/station/stream/stream_support.hpp"
#include "tools/forward/payload/compression.hpp"
#include "tools/forward/payload/json_payload.hpp"

namespace fieldcast::web {
namespace {

using test::catalogue_of;

const std::string kSubject = "fieldcast.north.line.press";

std::string payload() {
  forward::SampleBatch batch{"line", "press", 7, 99, {test::sample(1), test::sample(2)}};
  return forward::encode(batch);
}

SharedCatalogue find(const std::string& site, const std::string& bus, const std::string& device,
                     std::uint64_t identity) {
  if (site != "north" || bus != "line" || device != "press" || identity != 99) return nullptr;
  return std::make_shared<const forward::DeviceCatalogue>(catalogue_of("north:line", {"a"}));
}

DecodeFault fault_of(const std::string& subject, const std::string& data) {
  const auto batch = decode_batch({subject, data, {}}, find);
  EXPECT_FALSE(batch);
  return batch ? DecodeFault{} : batch.error();
}

TEST(MessageDecoder, ABusHasItsSiteInItsName) {
  const auto batch = decode_batch({kSubject, payload(), UtcTime{5}}, find);
  ASSERT_TRUE(batch);
  EXPECT_EQ(batch->site, "north");
  EXPECT_EQ(batch->samples.bus, "north:line");
  EXPECT_EQ(batch->samples.device, "press");
  EXPECT_EQ(batch->samples.samples.size(), 2U);
  EXPECT_EQ(batch->stored_at, UtcTime{5});
  EXPECT_FALSE(batch->is_late);
}

TEST(MessageDecoder, NamesAndTheLateSubjectAreRead) {
  const auto subject = stream_subject_from("fieldcast-late.north.line=2E7.press=2E1");
  ASSERT_TRUE(subject);
  EXPECT_EQ(subject->bus, "line.7");
  EXPECT_EQ(subject->device, "press.1");
  EXPECT_TRUE(subject->is_late);
}

TEST(MessageDecoder, AFrameOfZstdIsRead) {
  forward::SampleBatch batch{"line", "press", 7, 99, {}};
  for (std::uint64_t i = 1; i < 200; ++i) batch.samples.push_back(test::sample(i));
  const std::string data = forward::compressed(forward::encode(batch));
  ASSERT_TRUE(data.starts_with("\x28\xB5\x2F\xFD"));
  const auto read = decode_batch({kSubject, data, {}}, find);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->samples.samples, batch.samples);
}

TEST(MessageDecoder, JsonIsRead) {
  const forward::SampleBatch batch{"line", "press", 7, 99, {test::sample(1), test::sample(2)}};
  const auto text = forward::to_json("north", batch, catalogue_of("line", {"a"}));
  const auto read = decode_batch({kSubject, text, {}}, find);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->samples.samples, batch.samples);
  EXPECT_EQ(read->samples.bus, "north:line");
  EXPECT_EQ(fault_of(kSubject, "{\"schema\":2}"), DecodeFault::kSchema);
  EXPECT_EQ(fault_of(kSubject, "{\"schema\":1}"), DecodeFault::kContent);
  EXPECT_EQ(fault_of(kSubject, "{}"), DecodeFault::kForm);
  EXPECT_EQ(fault_of(kSubject, forward::to_json("north", batch, catalogue_of("line", {"b"}))),
            DecodeFault::kCatalogue);
  const auto catalogue =
      decode_catalogue("north", forward::to_json("north", catalogue_of("line", {"a"})));
  ASSERT_TRUE(catalogue);
  EXPECT_EQ(catalogue->channels.at(0).path(), "north:line/press/a");
}

TEST(MessageDecoder, EachFaultHasItsReason) {
  EXPECT_EQ(fault_of("fieldcast.north.line", payload()), DecodeFault::kSubject);
  EXPECT_EQ(fault_of("fieldcast.north.line.press.x", payload()), DecodeFault::kSubject);
  EXPECT_EQ(fault_of("fieldcast.north.=2.press", payload()), DecodeFault::kSubject);
  EXPECT_EQ(fault_of(kSubject, "\x28\xB5\x2F\xFD rest"), DecodeFault::kFrame);
  EXPECT_EQ(fault_of(kSubject, ""), DecodeFault::kForm);
  EXPECT_EQ(fault_of(kSubject, "poison"), DecodeFault::kForm);
  EXPECT_EQ(fault_of(kSubject, "\x08\x02" + payload().substr(2)), DecodeFault::kSchema);
  EXPECT_EQ(fault_of(kSubject, payload().substr(0, payload().size() - 3)), DecodeFault::kContent);
  EXPECT_EQ(fault_of("fieldcast.south.line.press", payload()), DecodeFault::kCatalogue);
}

TEST(MessageDecoder, AChannelBeyondTheCatalogueIsAFault) {
  forward::BatchSample sample = test::sample(1);
  sample.channel = 1;
  const forward::SampleBatch batch{"line", "press", 7, 99, {sample}};
  EXPECT_EQ(fault_of(kSubject, forward::encode(batch)), DecodeFault::kCatalogue);
}

TEST(MessageDecoder, AlarmsAndCataloguesHaveTheSiteInTheNameOfTheBus) {
  StationAlarmStatus alarm;
  alarm.alarm = {"line", "press", "a", LimitKind::kHigh};
  const auto read =
      decode_alarm({"fieldcast-alarm.north.line.press", forward::encode("north", alarm), {}});
  ASSERT_TRUE(read);
  EXPECT_EQ(read->alarm.bus, "north:line");
  const auto catalogue =
      decode_catalogue("north", forward::encode("north", catalogue_of("line", {"a"})));
  ASSERT_TRUE(catalogue);
  EXPECT_EQ(catalogue->channels.at(0).path(), "north:line/press/a");
}

}  // namespace
}  // namespace fieldcast::web
