#include "tools/station/notify/rule_engine.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>

namespace fieldcast::web {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::UnorderedElementsAre;

constexpr UtcTime kStart{1'790'000'000'000'000'000};
constexpr LocalMinute kNoon{0, 12 * 60};

AlarmKey key(const std::string& channel = "level") {
  return {"press-shop", "press-1", channel, LimitKind::kHigh};
}

NotifyRule rule(const std::string& name = "shift") {
  NotifyRule made;
  made.name = name;
  made.to = {"crew"};
  return made;
}

// An engine with a virtual clock and a store. restart() makes a new engine from what was stored.
class Rig {
 public:
  explicit Rig(std::vector<NotifyRule> rules) : rules_(std::move(rules)) { restart(); }

  void restart() {
    engine_ = std::make_unique<RuleEngine>(rules_);
    std::vector<NotifyProgress> progress;
    std::vector<NotifyWindow> windows;
    for (const auto& [name, row] : progress_) progress.push_back(row);
    for (const auto& [name, row] : windows_) windows.push_back(row);
    engine_->restore(progress, windows);
    for (const auto& [alarm, status] : plant_) engine_->on_alarm(alarm, status, now);
  }

  void raise(const AlarmKey& alarm = key()) {
    AlarmStatus& status = plant_[alarm];
    status.active = true;
    status.stage = AlarmStage::kUnacknowledged;
    status.raised_at = now;
    status.cleared_at = {};
    status.acknowledged = {};
    status.value = 39;
    tell(alarm);
  }
  void acknowledge(const AlarmKey& alarm = key()) {
    AlarmStatus& status = plant_[alarm];
    status.stage = status.active ? AlarmStage::kAcknowledged : AlarmStage::kClear;
    status.acknowledged = {"ann", "", now};
    tell(alarm);
  }
  void clear(const AlarmKey& alarm = key()) {
    AlarmStatus& status = plant_[alarm];
    status.active = false;
    status.cleared_at = now;
    status.stage =
        status.stage == AlarmStage::kUnacknowledged ? AlarmStage::kReturned : AlarmStage::kClear;
    tell(alarm);
  }
  AlarmStatus& status(const AlarmKey& alarm = key()) { return plant_[alarm]; }
  void tell(const AlarmKey& alarm = key()) { engine_->on_alarm(alarm, plant_[alarm], now); }

  // Texts "kind target" of the messages of each second until then.
  std::vector<std::string> pass(Duration time) {
    std::vector<std::string> texts;
    const UtcTime end{now.nanoseconds + time.count()};
    do {
      for (const NotifyMessage& message : step())
        texts.push_back(std::string(to_text(message.kind)) + ' ' + message.target);
      now.nanoseconds += Duration{seconds{1}}.count();
    } while (now < end);
    return texts;
  }
  std::vector<NotifyMessage> step() {
    RuleEngine::Due due = engine_->due(now, local);
    for (const NotifyProgress& row : due.progress) progress_[row.rule + to_text(row.alarm)] = row;
    for (const NotifyWindow& row : due.windows) {
      if (row.start.nanoseconds == 0)
        windows_.erase(row.rule + row.target);
      else
        windows_[row.rule + row.target] = row;
    }
    for (const NotifyMessage& message : due.messages)
      EXPECT_TRUE(ids_.insert(message.id).second) << "sent twice: " << to_text(message.kind);
    return due.messages;
  }
  [[nodiscard]] std::size_t stored_windows() const { return windows_.size(); }

  UtcTime now = kStart;
  LocalMinute local = kNoon;

 private:
  const std::vector<NotifyRule> rules_;
  std::unique_ptr<RuleEngine> engine_;
  std::map<AlarmKey, AlarmStatus> plant_;
  std::map<std::string, NotifyProgress> progress_;
  std::map<std::string, NotifyWindow> windows_;
  std::set<std::string> ids_;
};

TEST(RuleEngine, SendsAnAlarmOnceToEachTarget) {
  NotifyRule both = rule();
  both.to = {"crew", "chat"};
  Rig rig({both});
  EXPECT_THAT(rig.pass(seconds{3}), IsEmpty());
  rig.raise();
  EXPECT_THAT(rig.pass(hours{2}), ElementsAre("raised crew", "raised chat"));
}

TEST(RuleEngine, SendsOnlyWhatPatternAndPriorityName) {
  NotifyRule high = rule();
  high.priority = AlarmPriority::kHigh;
  high.patterns = {*Pattern::parse("press-shop/*/lev*"), *Pattern::parse("hall")};
  Rig rig({high});
  rig.raise();  // medium
  rig.status(key("speed")).priority = AlarmPriority::kCritical;
  rig.raise(key("speed"));
  EXPECT_THAT(rig.pass(seconds{5}), IsEmpty());
  rig.status(key("level-2")).priority = AlarmPriority::kCritical;
  rig.raise(key("level-2"));
  EXPECT_THAT(rig.pass(seconds{5}), ElementsAre("raised crew"));
}

TEST(RuleEngine, WaitsForTheDelayFromTheStartOfTheAlarm) {
  NotifyRule late = rule();
  late.delay = seconds{30};
  Rig rig({late});
  rig.raise();
  EXPECT_THAT(rig.pass(seconds{30}), IsEmpty());
  EXPECT_THAT(rig.pass(seconds{1}), ElementsAre("raised crew"));
}

TEST(RuleEngine, AnAlarmThatReturnsBeforeTheDelayIsNotSent) {
  NotifyRule late = rule();
  late.delay = seconds{30};
  late.cleared = true;
  Rig rig({late});
  rig.raise();
  EXPECT_THAT(rig.pass(seconds{20}), IsEmpty());
  rig.clear();
  EXPECT_THAT(rig.pass(minutes{5}), IsEmpty());
  rig.raise();
  EXPECT_THAT(rig.pass(seconds{30}), IsEmpty());
  EXPECT_THAT(rig.pass(seconds{1}), ElementsAre("raised crew"));
}

TEST(RuleEngine, AnAlarmAcknowledgedBeforeTheDelayIsNotSent) {
  NotifyRule late = rule();
  late.delay = seconds{30};
  Rig rig({late});
  rig.raise();
  (void)rig.pass(seconds{10});
  rig.acknowledge();
  EXPECT_THAT(rig.pass(minutes{5}), IsEmpty());
}

TEST(RuleEngine, RepeatsUntilItIsAcknowledgedAndAtMostAsOftenAsAllowed) {
  NotifyRule again = rule();
  again.repeat = minutes{10};
  again.repeats = 2;
  Rig rig({again});
  rig.raise();
  EXPECT_THAT(rig.pass(minutes{10}), ElementsAre("raised crew"));
  EXPECT_THAT(rig.pass(hours{3}), ElementsAre("repeated crew", "repeated crew"));
  rig.raise(key("speed"));
  EXPECT_THAT(rig.pass(minutes{15}), ElementsAre("raised crew", "repeated crew"));
  rig.acknowledge(key("speed"));
  EXPECT_THAT(rig.pass(hours{1}), IsEmpty());
}

TEST(RuleEngine, RepeatsAReturnedAlarmBecauseItIsNotAcknowledged) {
  NotifyRule again = rule();
  again.repeat = minutes{10};
  Rig rig({again});
  rig.raise();
  (void)rig.pass(minutes{1});
  rig.clear();
  EXPECT_THAT(rig.pass(minutes{10}), ElementsAre("repeated crew"));
  rig.acknowledge();
  EXPECT_THAT(rig.pass(hours{1}), IsEmpty());
}

TEST(RuleEngine, EscalatesInStepsFromTheFirstMessage) {
  NotifyRule steps = rule();
  steps.delay = minutes{1};
  steps.cleared = true;
  steps.escalate = {{minutes{15}, {"chief"}}, {minutes{30}, {"owner"}}};
  Rig rig({steps});
  rig.raise();
  EXPECT_THAT(rig.pass(minutes{16}), ElementsAre("raised crew"));
  EXPECT_THAT(rig.pass(minutes{10}), ElementsAre("escalated chief"));
  rig.acknowledge();
  EXPECT_THAT(rig.pass(hours{1}), IsEmpty());
  rig.clear();  // those who were informed, and only they, learn the end
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("cleared crew", "cleared chief"));
}

TEST(RuleEngine, SendsTheEndOnlyIfTheStartWasSent) {
  NotifyRule ends = rule();
  ends.cleared = true;
  Rig rig({ends});
  rig.raise();
  EXPECT_THAT(rig.pass(seconds{5}), ElementsAre("raised crew"));
  rig.clear();
  EXPECT_THAT(rig.pass(hours{1}), ElementsAre("cleared crew"));
  rig.acknowledge();
  EXPECT_THAT(rig.pass(hours{1}), IsEmpty());
  rig.raise();
  EXPECT_THAT(rig.pass(seconds{5}), ElementsAre("raised crew"));
}

TEST(RuleEngine, AnAlarmRaisedAgainIsANewOne) {
  Rig rig({rule()});
  rig.raise();
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
  rig.clear();
  (void)rig.pass(minutes{1});
  rig.raise();
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
  rig.acknowledge();
  rig.raise();  // the end between them was too short to be published
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
}

// Regression: it was silent until the clock reached the time of the closed occurrence.
TEST(RuleEngine, AnAlarmIsSentAgainAfterTheClockWasSetBack) {
  Rig rig({rule()});
  rig.raise();
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
  rig.acknowledge();
  rig.clear();
  EXPECT_THAT(rig.pass(minutes{1}), IsEmpty());
  rig.now.nanoseconds -= Duration{hours{2}}.count();
  rig.tell();
  EXPECT_THAT(rig.pass(minutes{1}), IsEmpty());
  rig.raise();
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
  rig.restart();
  EXPECT_THAT(rig.pass(minutes{1}), IsEmpty());
}

TEST(RuleEngine, WaitsForTheHours) {
  NotifyRule night = rule();
  night.hours = {*hours_from("18:00-06:00")};
  night.repeat = minutes{10};
  Rig rig({night});
  rig.raise();
  rig.raise(key("speed"));
  EXPECT_THAT(rig.pass(hours{1}), IsEmpty());
  rig.clear(key("speed"));
  rig.acknowledge(key("speed"));
  rig.local = {0, 18 * 60};
  EXPECT_THAT(rig.pass(minutes{5}), ElementsAre("raised crew"));
  rig.local = {1, 6 * 60};
  EXPECT_THAT(rig.pass(hours{5}), IsEmpty());  // no repeats by day
  rig.local = {1, 18 * 60};
  EXPECT_THAT(rig.pass(minutes{5}), ElementsAre("repeated crew"));
}

TEST(RuleEngine, AnEndOutsideTheHoursIsSentWhenTheyBegin) {
  NotifyRule day = rule();
  day.hours = {*hours_from("06:00-18:00")};
  day.cleared = true;
  Rig rig({day});
  rig.raise();
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
  rig.acknowledge();
  rig.local = {0, 20 * 60};
  rig.clear();
  EXPECT_THAT(rig.pass(hours{2}), IsEmpty());
  rig.local = {1, 6 * 60};
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("cleared crew"));
}

TEST(RuleEngine, AShelvedOrSuppressedAlarmWaits) {
  NotifyRule again = rule();
  again.repeat = minutes{10};
  Rig rig({again});
  rig.status().suppressed = {"ann", "", kStart, {kStart.nanoseconds + 1}};
  rig.raise();
  EXPECT_THAT(rig.pass(hours{1}), IsEmpty());
  rig.status().suppressed = {};
  rig.tell();
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
  rig.acknowledge();
  rig.status().shelved = {"ann", "", kStart, {kStart.nanoseconds + 1}};
  rig.tell();
  EXPECT_THAT(rig.pass(hours{1}), IsEmpty());
  rig.status().shelved = {};
  rig.status().stage = AlarmStage::kUnacknowledged;  // ISA-18.2: unacknowledged after shelving
  rig.tell();
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("repeated crew"));
}

TEST(RuleEngine, MoreMessagesThanAllowedBecomeADigest) {
  NotifyRule many = rule();
  many.digest = 2;
  many.digest_within = minutes{5};
  Rig rig({many});
  for (int i = 0; i < 5; ++i) rig.raise(key("c" + std::to_string(i)));
  EXPECT_THAT(rig.pass(minutes{5}), ElementsAre("raised crew", "raised crew"));
  const auto digest = rig.step();
  ASSERT_THAT(digest, SizeIs(1));
  EXPECT_EQ(digest[0].kind, NotifyKind::kDigest);
  EXPECT_EQ(std::count(digest[0].lines.begin(), digest[0].lines.end(), '\n'), 3);
  EXPECT_THAT(digest[0].lines, HasSubstr("raised, medium: press-shop/press-1/c2 high = 39, since"));
  // The flood continues: one digest for each window.
  rig.raise(key("c8"));
  EXPECT_THAT(rig.pass(minutes{5} + seconds{1}), ElementsAre("digest crew"));
  // After a window without messages, single messages are sent again.
  EXPECT_THAT(rig.pass(minutes{6}), IsEmpty());
  EXPECT_EQ(rig.stored_windows(), 0u);
  rig.raise(key("c9"));
  EXPECT_THAT(rig.pass(seconds{2}), ElementsAre("raised crew"));
}

TEST(RuleEngine, ADigestIsBounded) {
  NotifyRule many = rule();
  many.digest = 1;
  Rig rig({many});
  for (int i = 0; i < 1000; ++i) rig.raise(key("c" + std::to_string(i)));
  EXPECT_THAT(rig.pass(minutes{5}), SizeIs(1));
  const auto digest = rig.step();
  ASSERT_THAT(digest, SizeIs(1));
  EXPECT_EQ(std::count(digest[0].lines.begin(), digest[0].lines.end(), '\n'), 100);
  EXPECT_EQ(digest[0].more, 899u);
}

TEST(RuleEngine, ARestartInEachStateSendsNothingTwiceAndLosesNothing) {
  NotifyRule all = rule();
  all.delay = seconds{30};
  all.repeat = minutes{10};
  all.repeats = 2;
  all.cleared = true;
  all.escalate = {{minutes{15}, {"chief"}}};
  Rig rig({all});
  rig.raise();
  EXPECT_THAT(rig.pass(seconds{10}), IsEmpty());
  rig.restart();  // in the delay
  EXPECT_THAT(rig.pass(seconds{20}), IsEmpty());
  EXPECT_THAT(rig.pass(seconds{1}), ElementsAre("raised crew"));
  rig.restart();  // after the first message
  EXPECT_THAT(rig.pass(minutes{9}), IsEmpty());
  rig.restart();
  EXPECT_THAT(rig.pass(minutes{2}), ElementsAre("repeated crew"));
  rig.restart();  // after a repeat
  EXPECT_THAT(rig.pass(minutes{5}), ElementsAre("escalated chief"));
  rig.restart();  // after the escalation
  EXPECT_THAT(rig.pass(minutes{5}), ElementsAre("repeated crew"));
  rig.acknowledge();
  rig.restart();  // the progress is not yet acknowledged in the store
  EXPECT_THAT(rig.pass(hours{1}), IsEmpty());
  rig.restart();  // acknowledged
  rig.clear();
  rig.restart();  // returned, not yet sent
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("cleared crew", "cleared chief"));
  rig.restart();  // closed
  EXPECT_THAT(rig.pass(hours{1}), IsEmpty());
  rig.raise();
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
}

TEST(RuleEngine, ARestartKeepsTheDigest) {
  NotifyRule many = rule();
  many.digest = 1;
  Rig rig({many});
  for (const char* name : {"a", "b", "c"}) rig.raise(key(name));
  EXPECT_THAT(rig.pass(minutes{1}), SizeIs(1));
  rig.restart();
  rig.raise(key("d"));
  EXPECT_THAT(rig.pass(minutes{4}), IsEmpty());
  const auto digest = rig.step();
  ASSERT_THAT(digest, SizeIs(1));
  EXPECT_EQ(std::count(digest[0].lines.begin(), digest[0].lines.end(), '\n'), 3);
  rig.restart();
  EXPECT_THAT(rig.pass(hours{1}), IsEmpty());
}

TEST(RuleEngine, AMessageThatWasNotStoredIsDerivedAgainWithTheSameId) {
  RuleEngine first({rule()}), second({rule()});
  const AlarmStatus status{
      .stage = AlarmStage::kUnacknowledged, .active = true, .raised_at = kStart};
  first.on_alarm(key(), status, kStart);
  const UtcTime later{kStart.nanoseconds + 5'000'000'000};
  second.on_alarm(key(), status, later);
  const auto lost = first.due(kStart, kNoon).messages, again = second.due(later, kNoon).messages;
  ASSERT_THAT(lost, SizeIs(1));
  ASSERT_THAT(again, SizeIs(1));
  EXPECT_EQ(lost[0].id, again[0].id);
  EXPECT_THAT(lost[0].id, SizeIs(32));
}

TEST(RuleEngine, AnAlarmThatBeganAndEndedUnseenIsSentIfNobodyAcknowledgedIt) {
  Rig rig({rule()});
  rig.status().raised_at = {kStart.nanoseconds - Duration{hours{2}}.count()};
  rig.status().cleared_at = {kStart.nanoseconds - Duration{hours{1}}.count()};
  rig.status().stage = AlarmStage::kReturned;
  rig.tell();
  rig.status(key("old")).raised_at = {kStart.nanoseconds - Duration{hours{25}}.count()};
  rig.status(key("old")).cleared_at = kStart;
  rig.status(key("old")).stage = AlarmStage::kReturned;
  rig.tell(key("old"));
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
}

TEST(RuleEngine, ATakeoverOfTheBridgeContinuesTheAlarm) {
  Rig rig({rule()});
  rig.raise();
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
  rig.tell();  // the second bridge has the same store
  EXPECT_THAT(rig.pass(minutes{1}), IsEmpty());
  rig.raise();  // the second bridge has no store: raised later, but never ended
  EXPECT_THAT(rig.pass(minutes{1}), IsEmpty());
  rig.acknowledge();
  rig.status().stage = AlarmStage::kUnacknowledged;
  rig.status().raised_at = {kStart.nanoseconds - 1};  // an older state of a bridge that returns
  rig.tell();
  EXPECT_THAT(rig.pass(hours{1}), IsEmpty());
}

// Regression: the end and the new occurrence came while the station was suspended.
TEST(RuleEngine, AnAlarmThatEndedAndWasRaisedAgainUnseenIsANewOne) {
  Rig rig({rule()});
  rig.status().occurrences = 1;
  rig.raise();
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
  rig.status().occurrences = 2;
  rig.raise();
  EXPECT_THAT(rig.pass(minutes{1}), ElementsAre("raised crew"));
  rig.status().occurrences = 1;  // the first one was more than 10 minutes ago
  rig.tell();
  EXPECT_THAT(rig.pass(minutes{1}), IsEmpty());
}

TEST(RuleEngine, AClockAheadOfThisOneDoesNotHoldAMessage) {
  Rig rig({rule()});
  rig.raise();
  rig.status().raised_at = {kStart.nanoseconds + Duration{hours{5}}.count()};
  rig.tell();
  EXPECT_THAT(rig.pass(seconds{2}), ElementsAre("raised crew"));
}

TEST(RuleEngine, IgnoresTheProgressOfRulesThatWereRemoved) {
  RuleEngine engine({rule()});
  engine.restore({{.rule = "other", .alarm = key(), .count = 1}}, {{"other", "crew", kStart, 9}});
  engine.on_alarm(
      key(), {.stage = AlarmStage::kUnacknowledged, .active = true, .raised_at = kStart}, kStart);
  EXPECT_THAT(engine.due(kStart, kNoon).messages, SizeIs(1));
}

}  // namespace
}  // namespace fieldcast::web
