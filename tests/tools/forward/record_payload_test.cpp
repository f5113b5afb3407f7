#include "tools/forward/payload/record_payload.hpp"

#include <gtest/gtest.h>

#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/payload/codec.hpp"
#include "tools/forward/payload/json_payload.hpp"

namespace fieldcast::forward {
namespace {

struct RecordPayload : testing::Test {
  int found = 0;

  PayloadMaker maker(const PayloadSpec& spec) {
    return {"north", spec, [this](std::uint64_t identity) -> std::optional<std::string> {
              ++found;
              if (identity != 99) return std::nullopt;
              return encode("north", catalogue({"a"}));
            }};
  }
};

TEST_F(RecordPayload, ProtobufIsThatOfTheQueue) {
  const Record record = record_of(seconds(0, 3));
  EXPECT_EQ(maker({}).payload_of(record), record.body);
}

TEST_F(RecordPayload, JsonNamesTheChannelsOfTheCatalogue) {
  PayloadMaker json = maker({.format = PayloadFormat::kJson});
  EXPECT_EQ(json.payload_of(record_of(seconds(0, 3))),
            to_json("north", seconds(0, 3), catalogue({"a"})));
  EXPECT_TRUE(json.payload_of(record_of(seconds(3, 4))));
  EXPECT_EQ(found, 1) << "a catalogue is decoded once";
}

TEST_F(RecordPayload, ARecordThatCannotBeDecodedHasNoPayload) {
  PayloadMaker json = maker({.format = PayloadFormat::kJson});
  Record record = record_of(seconds(0, 3));
  record.body.resize(3);
  EXPECT_FALSE(json.payload_of(record));
  SampleBatch unknown = seconds(0, 3);
  unknown.catalogue = 1;
  EXPECT_FALSE(json.payload_of(record_of(unknown)));
  EXPECT_FALSE(json.payload_of({.kind = RecordKind::kAlarm, .body = "x"}));
  EXPECT_FALSE(json.payload_of({.kind = RecordKind::kCatalogue, .body = "x"}));
}

TEST_F(RecordPayload, OnlySamplesAreCompressed) {
  PayloadMaker compressing = maker({.format = PayloadFormat::kJson, .compress = true});
  EXPECT_TRUE(compressing.payload_of(record_of(seconds(0, 30)))->starts_with("\x28\xB5\x2F\xFD"));
  const Record record{.kind = RecordKind::kAlarm, .body = encode("north", alarm())};
  EXPECT_TRUE(compressing.payload_of(record)->starts_with("{"));
}

}  // namespace
}  // namespace fieldcast::forward
