#include "tools/forward/send/message_maker.hpp"

#include <gtest/gtest.h>

#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/payload/codec.hpp"
#include "tools/forward/payload/json_payload.hpp"
#include "tools/forward/send/subject.hpp"

namespace fieldcast::forward {
namespace {

struct MessageMakerTest : testing::Test {
  int found = 0;

  MessageMaker maker(const PayloadSpec& spec) {
    return {"north", "bucket", spec, [this](std::uint64_t identity) -> std::optional<std::string> {
              ++found;
              if (identity != 99) return std::nullopt;
              return encode("north", catalogue({"a"}));
            }};
  }
};

TEST_F(MessageMakerTest, ProtobufIsThatOfTheQueue) {
  Record record = record_of(seconds(0, 3));
  record.id = 5;
  const auto message = maker({}).make(record);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->record, 5u);
  EXPECT_EQ(message->subject, "fieldcast.north.line.press");
  EXPECT_EQ(message->id, message_id_of("north", record));
  EXPECT_EQ(message->payload, record.body);
}

TEST_F(MessageMakerTest, JsonNamesTheChannelsOfTheCatalogue) {
  MessageMaker json = maker({.format = PayloadFormat::kJson});
  const auto message = json.make(record_of(seconds(0, 3)));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->payload, to_json("north", seconds(0, 3), catalogue({"a"})));
  EXPECT_TRUE(json.make(record_of(seconds(3, 4))));
  EXPECT_EQ(found, 1) << "a catalogue is decoded once";
}

TEST_F(MessageMakerTest, ARecordThatCannotBeDecodedHasNoMessage) {
  MessageMaker json = maker({.format = PayloadFormat::kJson});
  Record record = record_of(seconds(0, 3));
  record.body.resize(3);
  EXPECT_FALSE(json.make(record));
  SampleBatch unknown = seconds(0, 3);
  unknown.catalogue = 1;
  EXPECT_FALSE(json.make(record_of(unknown)));
  EXPECT_FALSE(json.make({.kind = RecordKind::kAlarm, .body = "x"}));
  EXPECT_FALSE(json.make({.kind = RecordKind::kCatalogue, .body = "x"}));
}

TEST_F(MessageMakerTest, OnlySamplesAreCompressed) {
  MessageMaker compressing = maker({.format = PayloadFormat::kJson, .compress = true});
  EXPECT_TRUE(compressing.make(record_of(seconds(0, 30)))->payload.starts_with("\x28\xB5\x2F\xFD"));
  const Record record{.kind = RecordKind::kAlarm, .body = encode("north", alarm())};
  EXPECT_TRUE(compressing.make(record)->payload.starts_with("{"));
}

}  // namespace
}  // namespace fieldcast::forward
