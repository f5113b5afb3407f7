#include "bridge/alarm/alarm_actions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bridge/store/scratch.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

const UtcMapping kThen{Instant{1000s}, UtcTime{1'700'000'000'000'000'000}};

struct AlarmActionsTest : testing::Test {
  AlarmActionsTest() {
    BusSpec bus;
    bus.name = "shop";
    DeviceSpec& device = bus.devices.emplace_back();
    device.name = "press";
    ChannelSpec& channel = device.channels.emplace_back();
    channel.name = "level";
    channel.limits.high = 90;
    (void)alarms.configure({bus}, kThen.utc);
    alarms.note({"shop", "press", "level", "high", "active", 91, kThen.utc});
    commands.open(&audit);
  }
  static AlarmAction acknowledge(std::uint64_t id) {
    AlarmAction action;
    action.requester = "cli:1:2";
    action.request_id = id;
    action.alarm = {"shop", "press", "level", LimitKind::kHigh};
    action.by = "anna";
    action.note = "on my way";
    return action;
  }
  AlarmTable alarms;
  test::RecordingAudit audit;
  CommandAudit commands;
  std::string ended;  // the last session that was to be ended
  AlarmActions actions{
      alarms, commands,
      [this](const std::string& bus, const std::string& device, const std::string& reason) {
        ended = bus + '/' + device + ": " + reason;
        return device == "press";
      }};
};

TEST_F(AlarmActionsTest, TheAuditNamesTheAuthenticatedSubject) {
  AlarmAction action = acknowledge(1);
  action.subject = "plant mes";
  EXPECT_EQ(audit_entry(action).who, "anna (plant mes, cli:1:2)");
}

TEST_F(AlarmActionsTest, EachHasOneResultAndOneEntryInTheAudit) {
  const CommandResult done = actions.take(acknowledge(1), kThen);
  EXPECT_EQ(done.state, CommandState::kDone);
  EXPECT_EQ(done.cause, Cause::kNone);
  EXPECT_EQ(done.reason, "");
  EXPECT_EQ(done.requester, "cli:1:2");
  EXPECT_EQ(done.request_id, 1u);
  EXPECT_EQ(done.completed, kThen.instant);
  const CommandResult again = actions.take(acknowledge(2), kThen);
  EXPECT_EQ(again.state, CommandState::kRejected);
  EXPECT_EQ(again.cause, Cause::kWrongState);
  const std::string action = "anna (cli:1:2) | acknowledge high: on my way | shop/press/level | ";
  EXPECT_EQ(audit.rows(), (std::vector{action + "done",
                                       action + "rejected: it is acknowledged already, by anna"}));
}

TEST_F(AlarmActionsTest, ADuplicateChangesNothing) {
  (void)actions.take(acknowledge(1), kThen);
  AlarmAction other = acknowledge(1);
  other.kind = AlarmActionKind::kShelve;
  other.duration = 1h;
  EXPECT_EQ(actions.take(other, kThen).cause, Cause::kDuplicate);
  EXPECT_FALSE(alarms.status_of(other.alarm)->shelved.is_set());
}

TEST_F(AlarmActionsTest, EndsAProgrammingSession) {
  AlarmAction action = acknowledge(1);
  action.kind = AlarmActionKind::kEndSession;
  EXPECT_EQ(actions.take(action, kThen).state, CommandState::kDone);
  EXPECT_EQ(ended, "shop/press: ended by anna: on my way");
  EXPECT_EQ(audit.rows(),
            (std::vector<std::string>{
                "anna (cli:1:2) | end programming session: on my way | shop/press | done"}));
  action.request_id = 2;
  action.alarm.device = "pump";
  EXPECT_EQ(actions.take(action, kThen).reason, "nobody programs the device");
  action.request_id = 3;
  action.by.clear();
  EXPECT_EQ(actions.take(action, kThen).state, CommandState::kRejected);
}

TEST_F(AlarmActionsTest, TheAuditSaysForHowLong) {
  AlarmAction action = acknowledge(1);
  action.kind = AlarmActionKind::kShelve;
  action.duration = 30min;
  action.note.clear();
  EXPECT_EQ(audit_entry(action).what, "shelve high for 30min");
  action.kind = AlarmActionKind::kMaintenance;
  EXPECT_EQ(audit_entry(action).what, "maintenance for 30min");
  EXPECT_EQ(audit_entry(action).target, "shop/press");
  action.kind = AlarmActionKind::kEndMaintenance;
  EXPECT_EQ(audit_entry(action).what, "end maintenance");
}

}  // namespace
}  // namespace fieldcast
