#include "tools/forward/outlet/nats/subject.hpp"

#include <gtest/gtest.h>

#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/outlet/message_id.hpp"

namespace fieldcast::forward {
namespace {

TEST(Subject, CharactersThatNatsForbidsAreEscaped) {
  EXPECT_EQ(subject_token("press-1_A"), "press-1_A");
  EXPECT_EQ(subject_token("a.b c*>"), "a=2Eb=20c=2A=3E");
  EXPECT_EQ(subject_token("a=2Eb"), "a=3D2Eb") << "two names never get one token";
  EXPECT_EQ(subject_token("ü\n"), "=C3=BC=0A");
  EXPECT_EQ(subject_token(""), "=");
}

TEST(Subject, NamesSiteBusAndDevice) {
  Record record{.bus = "line", .device = "press.1", .identity = 0xAB};
  EXPECT_EQ(subject_of("north", "bucket", record), "fieldcast.north.line.press=2E1");
  record.kind = RecordKind::kAlarm;
  EXPECT_EQ(subject_of("north", "bucket", record), "fieldcast-alarm.north.line.press=2E1");
  record.kind = RecordKind::kCatalogue;
  EXPECT_EQ(subject_of("north", "bucket", record), "$KV.bucket.north.line.press=2E1.ab");
  record.kind = RecordKind::kSamples;
  record.is_late = true;
  EXPECT_EQ(subject_of("north", "bucket", record), "fieldcast-late.north.line.press=2E1");
  EXPECT_EQ(subject_of("north", "bucket", {.kind = RecordKind::kAudit, .bus = "plant"}),
            "fieldcast-audit.north.plant");
  EXPECT_EQ(site_subject_of("sites", "north 1"), "$KV.sites.north=201");
  EXPECT_EQ(command_subject_of("north"), "fieldcast-command.north.*");
  EXPECT_EQ(command_subject_of("north.1", "anna@hq"), "fieldcast-command.north=2E1.anna=40hq");
}

TEST(Subject, ATokenHasOneName) {
  for (const char* name : {"anna", "a.b@c", "ü", "=", ""})
    EXPECT_EQ(name_of_token(subject_token(name)), name);
  for (const char* token : {"=4", "=zz", "=61", "a b", "=2e"})
    EXPECT_EQ(name_of_token(token), "") << token << " is not the token of a name";
}

TEST(MessageId, IsThatOfTheSamples) {
  const Record record = record_of(seconds(0, 3));
  EXPECT_EQ(message_id_of("north", record), message_id_of("north", record_of(seconds(0, 3))));
  EXPECT_NE(message_id_of("north", record), message_id_of("south", record));
  EXPECT_NE(message_id_of("north", record), message_id_of("north", record_of(seconds(0, 4))));
  EXPECT_TRUE(message_id_of("north", record).starts_with("north/line/7/"));
}

TEST(MessageId, OfAnAlarmThatReturnsToAnEarlierStateIsNew) {
  const StationAlarmStatus shelved = alarm();
  StationAlarmStatus raised = shelved;
  raised.status.shelved = {};
  const auto id_of = [](const Position& position) {
    return message_id_of("north", {.kind = RecordKind::kAlarm,
                                   .bus = "line",
                                   .device = "press",
                                   .epoch = position.epoch,
                                   .identity = position.sequence});
  };
  const auto first = next_position({}, raised);
  ASSERT_TRUE(first);
  EXPECT_FALSE(next_position(*first, raised)) << "a reader can get a state twice";
  const auto second = next_position(*first, shelved);
  ASSERT_TRUE(second);
  const auto third = next_position(*second, raised);
  ASSERT_TRUE(third);
  EXPECT_NE(id_of(*first), id_of(*second));
  EXPECT_NE(id_of(*first), id_of(*third));
}

}  // namespace
}  // namespace fieldcast::forward
