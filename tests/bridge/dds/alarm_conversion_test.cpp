#include <gtest/gtest.h>

#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

const AlarmKey kAlarm{"press-shop", "press-1", "level", LimitKind::kLowLow};

AlarmStatus full() {
  AlarmStatus status;
  status.priority = AlarmPriority::kCritical;
  status.stage = AlarmStage::kReturned;
  status.value = -4.25;
  status.raised_at = {10};
  status.cleared_at = {20};
  status.occurrences = 7;
  status.chattering = true;
  status.acknowledged = {"anna", "the pump is off", {15}};
  status.shelved = {"bert", "until the filter is changed", {16}, {30}};
  status.suppressed = {"chen", "inspection", {17}, {40}};
  return status;
}

TEST(AlarmConversion, AStatusComesBack) {
  idl::AlarmStatus topic;
  to_idl(kAlarm, full(), topic);
  const auto back = from_idl(topic);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->alarm, kAlarm);
  EXPECT_EQ(back->status, full());
}

TEST(AlarmConversion, AStatusWithAnUnknownEnumeratorIsNone) {
  for (const int which : {0, 1, 2}) {
    idl::AlarmStatus topic;
    to_idl(kAlarm, full(), topic);
    if (which == 0) topic.limit(idl::LimitKind::LIMIT_WRITE_MAX);
    if (which == 1) topic.priority(static_cast<idl::AlarmPriority>(4));
    if (which == 2) topic.stage(static_cast<idl::AlarmStage>(4));
    EXPECT_FALSE(from_idl(topic)) << which;
  }
}

TEST(AlarmConversion, ALongTextOfAStatusIsCutBetweenCharacters) {
  AlarmStatus status;
  for (int i = 0; i < 40; ++i) status.acknowledged.by += "ä";
  status.shelved.note.assign(300, 'x');
  idl::AlarmStatus topic;
  to_idl(kAlarm, status, topic);
  EXPECT_EQ(topic.acknowledged().by().size(), 64u);
  EXPECT_EQ(topic.shelved().note().size(), 256u);
}

AlarmAction shelve() {
  AlarmAction action;
  action.requester = "cli:1:2";
  action.request_id = 9;
  action.kind = AlarmActionKind::kShelve;
  action.alarm = kAlarm;
  action.by = "anna";
  action.note = "Ventil geöffnet";
  action.duration = 30min;
  action.raised_at = {10};
  return action;
}

TEST(AlarmConversion, AnActionComesBack) {
  idl::AlarmAction topic;
  ASSERT_TRUE(to_idl(shelve(), topic));
  const auto back = from_idl(topic);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->requester, "cli:1:2");
  EXPECT_EQ(back->request_id, 9u);
  EXPECT_EQ(back->kind, AlarmActionKind::kShelve);
  EXPECT_EQ(back->alarm, kAlarm);
  EXPECT_EQ(back->by, "anna");
  EXPECT_EQ(back->note, "Ventil geöffnet");
  EXPECT_EQ(back->duration, 30min);
  EXPECT_EQ(back->raised_at.nanoseconds, 10);
}

TEST(AlarmConversion, AnActionThatDoesNotFitIsNotSent) {
  const auto too_long = [](std::string AlarmAction::*text, std::size_t length) {
    AlarmAction action = shelve();
    action.*text = std::string(length, 'x');
    idl::AlarmAction topic;
    return !to_idl(action, topic);
  };
  EXPECT_FALSE(too_long(&AlarmAction::by, 64));
  EXPECT_TRUE(too_long(&AlarmAction::by, 65));
  EXPECT_FALSE(too_long(&AlarmAction::note, 256));
  EXPECT_TRUE(too_long(&AlarmAction::note, 257));
  EXPECT_TRUE(too_long(&AlarmAction::requester, 129));
  AlarmAction action = shelve();
  action.alarm.channel.assign(65, 'c');
  idl::AlarmAction topic;
  EXPECT_FALSE(to_idl(action, topic));
}

TEST(AlarmConversion, AnActionFromOutsideIsNotTrusted) {
  idl::AlarmAction topic;
  ASSERT_TRUE(to_idl(shelve(), topic));
  topic.kind(static_cast<idl::AlarmActionKind>(77));
  ASSERT_FALSE(from_idl(topic));
  EXPECT_EQ(from_idl(topic).error().cause, Cause::kUnsupported);

  ASSERT_TRUE(to_idl(shelve(), topic));
  topic.limit(idl::LimitKind::LIMIT_WRITE_MIN);
  ASSERT_FALSE(from_idl(topic));
  EXPECT_EQ(from_idl(topic).error().cause, Cause::kUnknownChannel);
  topic.kind(idl::AlarmActionKind::ACTION_MAINTENANCE);  // of a device: the limit is ignored
  EXPECT_TRUE(from_idl(topic));

  ASSERT_TRUE(to_idl(shelve(), topic));
  topic.by() = std::string("anna\n\x1b[31m");
  topic.note() = std::string(200, '\xff');  // invalid UTF-8: four characters per byte
  const auto back = from_idl(topic);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->by, "anna\\n\\x1B[31m");
  EXPECT_LE(back->note.size(), 256u);
  EXPECT_TRUE(back->note.starts_with("\\xFF\\xFF"));
}

}  // namespace
}  // namespace fieldcast
