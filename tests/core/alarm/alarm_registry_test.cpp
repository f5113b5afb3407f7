#include "core/alarm/alarm_registry.hpp"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <random>

#include "tests/core/alarm/alarm_transcript.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using namespace alarm_transcript;

void expect_replayed(const std::string& text) { EXPECT_EQ(Transcript().replay(text), text); }

TEST(AlarmRegistry, AcknowledgedActiveAndReturned) {
  expect_replayed(R"(# acknowledged while it is active
0s raise shop/press-1/level high 91
  shop/press-1/level high: unacknowledged, active, medium, 1 times
1s raise shop/press-1/level high 92
  nothing
2s anna acknowledges shop/press-1/level high
  event: shop/press-1/level high acknowledged by anna
  shop/press-1/level high: acknowledged, active, medium, 1 times, acked by anna at 2s
3s bo acknowledges shop/press-1/level high
  refused: it is acknowledged already, by anna (WRONG_STATE)
4s clear shop/press-1/level high 80
  shop/press-1/level high: clear, medium, 1 times, acked by anna at 2s
5s clear shop/press-1/level high 80
  nothing
6s bo acknowledges shop/press-1/level high
  refused: the alarm is clear: there is nothing to acknowledge (WRONG_STATE)

# nobody saw it before it returned; it comes again before somebody does
10s raise shop/press-1/level high-high 96
  shop/press-1/level high-high: unacknowledged, active, high, 1 times
11s clear shop/press-1/level high-high 94
  shop/press-1/level high-high: returned, high, 1 times
12s raise shop/press-1/level high-high 97
  shop/press-1/level high-high: unacknowledged, active, high, 2 times
13s clear shop/press-1/level high-high 94
  shop/press-1/level high-high: returned, high, 2 times
14s bo acknowledges shop/press-1/level high-high
  event: shop/press-1/level high-high acknowledged by bo
  shop/press-1/level high-high: clear, high, 2 times, acked by bo at 14s
15s raise shop/press-1/valve high 1
  shop/press-1/valve high: unacknowledged, active, critical, 1 times
)");
}

TEST(AlarmRegistry, ShelvedForAWhile) {
  expect_replayed(R"(0s anna shelves shop/press-1/level low for 30min
  event: shop/press-1/level low shelved by anna until 30min
  shop/press-1/level low: clear, medium, shelved by anna until 30min
1min raise shop/press-1/level low 9
  shop/press-1/level low: unacknowledged, active, medium, 1 times, shelved by anna until 30min
2min anna acknowledges shop/press-1/level low
  refused: the alarm is shelved (WRONG_STATE)
3min time
29min time
  shop/press-1/level low: unacknowledged, active, medium, shelved by anna until 30min
30min time
  event: shop/press-1/level low shelving ended
  shop/press-1/level low: unacknowledged, active, medium
31min bo acknowledges shop/press-1/level low
  event: shop/press-1/level low acknowledged by bo
  shop/press-1/level low: acknowledged, active, medium, acked by bo at 31min
32min bo shelves shop/press-1/level low for 24h
  event: shop/press-1/level low shelved by bo until 1472min
  shop/press-1/level low: unacknowledged, active, medium, acked by bo at 31min)"
                  R"(, shelved by bo until 1472min
33min clear shop/press-1/level low 20
  shop/press-1/level low: clear, medium, acked by bo at 31min, shelved by bo until 1472min
34min anna unshelves shop/press-1/level low
  event: shop/press-1/level low unshelved by anna
  shop/press-1/level low: clear, medium, acked by bo at 31min
35min anna unshelves shop/press-1/level low
  refused: the alarm is not shelved (WRONG_STATE)
)");
}

TEST(AlarmRegistry, ADeviceInMaintenance) {
  expect_replayed(R"(0s raise shop/press-2/valve high 2
  shop/press-2/valve high: unacknowledged, active, critical, 1 times
1s chen maintains shop/press-2 for 2h
  event: shop/press-2 maintenance by chen until 7201s
  shop/press-2/level low-low: clear, high, suppressed until 7201s
  shop/press-2/level low: clear, medium, suppressed until 7201s
  shop/press-2/level high: clear, medium, suppressed until 7201s
  shop/press-2/level high-high: clear, high, suppressed until 7201s
  shop/press-2/valve high: unacknowledged, active, critical, 1 times, suppressed until 7201s
2s anna acknowledges shop/press-2/valve high
  refused: its device is in maintenance (WRONG_STATE)
3s clear shop/press-2/valve high 0
  shop/press-2/valve high: clear, critical, 1 times, suppressed until 7201s
4s raise shop/press-2/level high 91
  shop/press-2/level high: unacknowledged, active, medium, 1 times, suppressed until 7201s
5s raise shop/press-1/level high 91
  shop/press-1/level high: unacknowledged, active, medium, 1 times
7200s time
  shop/press-1/level high: unacknowledged, active, medium
  shop/press-2/level high: unacknowledged, active, medium, suppressed until 7201s
  shop/press-2/valve high: clear, critical, suppressed until 7201s
7201s time
  event: shop/press-2 maintenance ended
  shop/press-2/level low-low: clear, high
  shop/press-2/level low: clear, medium
  shop/press-2/level high: unacknowledged, active, medium
  shop/press-2/level high-high: clear, high
  shop/press-2/valve high: clear, critical
7202s chen ends shop/press-2
  refused: the device is not in maintenance (WRONG_STATE)
)");
}

TEST(AlarmRegistry, Chatters) {
  expect_replayed(R"(0s raise shop/press-1/level high 91
  shop/press-1/level high: unacknowledged, active, medium, 1 times
1s clear shop/press-1/level high 89
  shop/press-1/level high: returned, medium, 1 times
2s raise shop/press-1/level high 91
  shop/press-1/level high: unacknowledged, active, medium, 2 times
3s clear shop/press-1/level high 89
  shop/press-1/level high: returned, medium, 2 times
4s raise shop/press-1/level high 91
  shop/press-1/level high: unacknowledged, active, medium, 3 times
5s clear shop/press-1/level high 89
  shop/press-1/level high: returned, medium, 3 times
6s raise shop/press-1/level high 91
  shop/press-1/level high: unacknowledged, active, medium, 4 times
7s clear shop/press-1/level high 89
  shop/press-1/level high: returned, medium, 4 times
8s raise shop/press-1/level high 91
  event: shop/press-1/level high chattering
  shop/press-1/level high: unacknowledged, active, medium, 5 times, chattering
602s time
  shop/press-1/level high: unacknowledged, active, medium, 3 times, chattering
604s time
  event: shop/press-1/level high chattering ended
  shop/press-1/level high: unacknowledged, active, medium, 2 times
)");
}

TEST(AlarmRegistry, RefusesWhatCannotBe) {
  expect_replayed(R"(0s nobody acknowledges shop/press-1/level high
  refused: it must say who does it (RANGE)
0s anna acknowledges shop/press-1/plain high
  refused: there is no such limit: shop/press-1/plain high (UNKNOWN_CHANNEL)
0s anna acknowledges shop/press-9/level high
  refused: there is no such limit: shop/press-9/level high (UNKNOWN_CHANNEL)
0s anna acknowledges shop/press-1/level high
  refused: the alarm is clear: there is nothing to acknowledge (WRONG_STATE)
0s anna unshelves shop/press-1/level high
  refused: the alarm is not shelved (WRONG_STATE)
0s anna shelves shop/press-1/level high
  refused: an alarm is shelved for up to 24 hours (RANGE)
0s anna shelves shop/press-1/level high for 1441min
  refused: an alarm is shelved for up to 24 hours (RANGE)
0s anna maintains shop/press-1
  refused: maintenance takes up to 7 days (RANGE)
0s anna maintains shop/press-1 for 169h
  refused: maintenance takes up to 7 days (RANGE)
0s anna maintains shop/press-9 for 1h
  refused: there is no device with alarms: shop/press-9 (UNKNOWN_DEVICE)
0s anna maintains shop for 1h
  refused: there is no device with alarms: shop/ (UNKNOWN_DEVICE)
0s anna maintains zoo/press-1 for 1h
  refused: there is no device with alarms: zoo/press-1 (UNKNOWN_DEVICE)
0s raise shop/press-1/plain high 5
  nothing
0s clear shop/press-1/level high 5
  nothing
)");
}

TEST(AlarmRegistry, ANegativeDurationIsRefused) {
  AlarmRegistry book;
  (void)book.configure(two_buses());
  AlarmAction action;
  action.by = "anna";
  action.alarm = {"shop", "press-1", "level", LimitKind::kHigh};
  for (const Duration length : {Duration{-1}, Duration::min(), Duration::max()}) {
    action.duration = length;
    action.kind = AlarmActionKind::kShelve;
    EXPECT_FALSE(book.act(action, after(0s)));
    action.kind = AlarmActionKind::kMaintenance;
    EXPECT_FALSE(book.act(action, after(0s)));
  }
}

KeptAlarms kept_of(AlarmRegistry& book) {
  KeptAlarms kept;
  AlarmRegistry::News news = book.take_news();
  for (const AlarmKey& alarm : news.to_keep) {
    AlarmStatus status = *book.find(alarm);
    status.suppressed = {};
    kept.states.push_back({alarm, status});
    if (status.active) kept.active.push_back({alarm, status});
    if (status.occurrences > 0) kept.occurrences.emplace_back(alarm, status.raised_at);
  }
  kept.maintenance = news.maintenance;
  return kept;
}

TEST(AlarmRegistry, ARestartChangesNothing) {
  AlarmRegistry before;
  (void)before.configure(two_buses());
  const auto alarm = [](const char* channel, LimitKind limit) {
    return AlarmKey{"shop", "press-1", channel, limit};
  };
  const AlarmKey acknowledged = alarm("level", LimitKind::kHigh),
                 returned = alarm("level", LimitKind::kLow),
                 shelved = alarm("level", LimitKind::kLowLow),
                 plain = alarm("valve", LimitKind::kHigh),
                 suppressed{"shop", "press-2", "level", LimitKind::kHigh};
  for (const AlarmKey& each : {acknowledged, returned, shelved, plain, suppressed})
    (void)before.raise(each, 91, after(1s), after(1s));
  (void)before.clear(returned, 50, after(2s));
  AlarmAction action{.by = "anna", .note = "seen"};
  action.alarm = acknowledged;
  ASSERT_TRUE(before.act(action, after(3s)));
  action.kind = AlarmActionKind::kShelve;
  action.alarm = shelved;
  action.duration = 1h;
  ASSERT_TRUE(before.act(action, after(3s)));
  action.kind = AlarmActionKind::kMaintenance;
  action.alarm = {"shop", "press-2", {}, {}};
  ASSERT_TRUE(before.act(action, after(3s)));

  EXPECT_EQ(before.counts(), (AlarmCounts{1, 1, 1, 1, 5, 0}));
  AlarmRegistry restarted;
  (void)restarted.configure(two_buses());
  (void)restarted.raise(plain, 99, after(5s), after(5s));  // before the store was open
  EXPECT_TRUE(restarted.restore(kept_of(before), after(10s)).empty());
  for (const AlarmKey& each : {acknowledged, returned, shelved, plain, suppressed}) {
    ASSERT_NE(restarted.find(each), nullptr) << to_text(each);
    EXPECT_EQ(status_text(*restarted.find(each)), status_text(*before.find(each))) << to_text(each);
    EXPECT_EQ(restarted.find(each)->raised_at, after(1s));
    EXPECT_EQ(restarted.find(each)->acknowledged, before.find(each)->acknowledged);
  }
  restarted.on_time("shop", after(2h));
  EXPECT_FALSE(restarted.find(shelved)->shelved.is_set()) << "it ends after the restart too";
  EXPECT_FALSE(restarted.find(suppressed)->suppressed.is_set());
  EXPECT_EQ(restarted.find(acknowledged)->stage, AlarmStage::kAcknowledged);
}

TEST(AlarmRegistry, AStoreOfBeforeKnowsActiveAlarmsOnly) {
  AlarmRegistry book;
  (void)book.configure(two_buses());
  KeptAlarms kept;
  const AlarmKey active{"shop", "press-1", "level", LimitKind::kHigh},
      not_ours{"of another bridge", "press-1", "level", LimitKind::kHigh},
      taken_away{"shop", "press-1", "plain", LimitKind::kHigh};
  for (const AlarmKey& alarm : {active, not_ours, taken_away}) {
    AlarmStatus status;
    status.value = 93;
    status.raised_at = after(1s);
    kept.active.push_back({alarm, status});
    kept.occurrences.emplace_back(alarm, after(1s));
  }
  const auto ended = book.restore(kept, after(5s));
  ASSERT_EQ(ended.size(), 1u);
  EXPECT_EQ(ended[0].alarm, taken_away);
  EXPECT_EQ(status_text(*book.find(active)), "unacknowledged, active, medium, 1 times");
  EXPECT_EQ(book.find(active)->value, 93);
  EXPECT_EQ(book.find(active)->raised_at, after(1s));
  EXPECT_EQ(book.find(active)->cleared_at, UtcTime{});
  EXPECT_EQ(book.find(not_ours), nullptr);
  EXPECT_EQ(book.find(taken_away), nullptr);
}

// The bridge stopped between the two changes: the limit was exceeded again, the state was not kept.
TEST(AlarmRegistry, AnOccurrenceThatIsOnlyActiveInTheStoreIsOneOfItsOwn) {
  AlarmRegistry registry;
  (void)registry.configure(two_buses());
  const AlarmKey alarm{"shop", "press-1", "level", LimitKind::kHigh};
  AlarmStatus before, again;
  before.raised_at = after(1s);
  before.cleared_at = after(2s);
  before.value = 80;
  before.acknowledged = {"anna", "seen", after(2s)};
  again.raised_at = after(3s);
  again.value = 95;
  KeptAlarms kept;
  kept.states.push_back({alarm, before});
  kept.active.push_back({alarm, again});
  EXPECT_TRUE(registry.restore(kept, after(5s)).empty());
  const AlarmStatus* status = registry.find(alarm);
  ASSERT_NE(status, nullptr);
  EXPECT_EQ(status->stage, AlarmStage::kUnacknowledged);
  EXPECT_TRUE(status->active);
  EXPECT_EQ(status->value, 95);
  EXPECT_EQ(status->raised_at, after(3s));
  EXPECT_EQ(status->cleared_at, UtcTime{});
  EXPECT_EQ(status->acknowledged, AlarmNote{}) << "it was of the occurrence before";
}

// The bridge stopped between the two changes: the store has the end of the alarm and its old state.
TEST(AlarmRegistry, AnAlarmThatIsNoLongerActiveInTheStoreHasEnded) {
  AlarmRegistry registry;
  (void)registry.configure(two_buses());
  const AlarmKey alarm{"shop", "press-1", "level", LimitKind::kHigh},
      taken_away{"shop", "press-1", "plain", LimitKind::kHigh};
  AlarmStatus kept_status;
  kept_status.stage = AlarmStage::kAcknowledged;
  kept_status.active = true;
  kept_status.value = 95;
  KeptAlarms kept;
  for (const AlarmKey& each : {alarm, taken_away}) kept.states.push_back({each, kept_status});
  kept.maintenance.push_back({{"of another bridge", "press-1"}, {"bo", "", after(1s), after(2h)}});
  const auto ended = registry.restore(kept, after(5s));
  ASSERT_EQ(ended.size(), 1u);
  EXPECT_EQ(ended[0].alarm, taken_away);
  EXPECT_FALSE(ended[0].status.active);
  ASSERT_NE(registry.find(alarm), nullptr);
  EXPECT_EQ(registry.find(alarm)->stage, AlarmStage::kClear);
  EXPECT_FALSE(registry.find(alarm)->active);
  EXPECT_EQ(registry.find(alarm)->cleared_at, after(5s));
  EXPECT_EQ(registry.find(taken_away), nullptr);
  EXPECT_EQ(registry.take_news().to_keep, (std::set<AlarmKey>{alarm, taken_away}));
  registry.on_time("of another bridge", after(3h));
  EXPECT_TRUE(registry.take_news().events.empty()) << "the maintenance of another bridge";
}

TEST(AlarmRegistry, CountsWhatIsClearAndWhatChatters) {
  AlarmRegistry registry;
  (void)registry.configure(two_buses());
  const AlarmKey alarm{"shop", "press-1", "level", LimitKind::kHigh};
  AlarmAction action{.by = "anna"};
  action.alarm = alarm;
  for (int i = 0; i < 5; ++i) {
    (void)registry.raise(alarm, 91, after(1s), after(1s));
    ASSERT_TRUE(registry.act(action, after(1s)));
    (void)registry.clear(alarm, 50, after(2s));
  }
  EXPECT_EQ(registry.counts(), (AlarmCounts{0, 0, 0, 0, 0, 1}));
}

TEST(AlarmRegistry, ARestoredBusLosesAlarmsThatAreNotStored) {
  AlarmRegistry registry;
  (void)registry.configure(two_buses());
  const AlarmKey ours{"shop", "press-1", "level", LimitKind::kHigh},
      others{"yard", "press-1", "level", LimitKind::kHigh};
  for (const AlarmKey& alarm : {ours, others})
    (void)registry.raise(alarm, 91, after(1s), after(1s));
  (void)registry.take_news();
  EXPECT_TRUE(registry.restore("shop", {}, after(2s)).empty());
  EXPECT_EQ(registry.find(ours), nullptr);
  EXPECT_NE(registry.find(others), nullptr);
  EXPECT_EQ(registry.take_news().changed, std::set<AlarmKey>{ours});
}

TEST(AlarmRegistry, AnAlarmWhoseLimitIsTakenAwayIsForgotten) {
  AlarmRegistry book;
  (void)book.configure(two_buses());
  const AlarmKey alarm{"shop", "press-1", "valve", LimitKind::kHigh};
  (void)book.raise(alarm, 2, after(1s), after(1s));
  (void)book.take_news();
  auto buses = two_buses();
  buses[0].devices[0].channels[2].limits = {};
  const auto ended = book.configure(buses);
  ASSERT_EQ(ended.size(), 1u);
  EXPECT_EQ(ended[0].alarm, alarm);
  EXPECT_EQ(book.find(alarm), nullptr);
  EXPECT_TRUE(book.take_news().changed.contains(alarm));
  EXPECT_TRUE(book.known_of("shop").empty());
}

TEST(AlarmRegistry, ANewPriorityHoldsImmediately) {
  AlarmRegistry book;
  (void)book.configure(two_buses());
  const AlarmKey alarm{"shop", "press-1", "level", LimitKind::kHigh};
  (void)book.raise(alarm, 91, after(1s), after(1s));
  (void)book.take_news();
  auto buses = two_buses();
  buses[0].devices[0].channels[0].limits.priority = AlarmPriority::kCritical;
  EXPECT_TRUE(book.configure(buses).empty());
  EXPECT_EQ(book.find(alarm)->priority, AlarmPriority::kCritical);
  EXPECT_TRUE(book.take_news().changed.contains(alarm));
}

// After random events, every alarm has a state of the standard; a restart changes none.
TEST(AlarmRegistry, EveryDayKeepsItsRules) {
  std::mt19937 random(13);
  const auto pick = [&](std::uint32_t below) { return random() % below; };
  std::vector<AlarmKey> alarms;
  for (const char* device : {"press-1", "press-2"}) {
    for (const LimitKind kind : {LimitKind::kLow, LimitKind::kHigh, LimitKind::kHighHigh})
      alarms.push_back({"shop", device, "level", kind});
  }
  auto book = std::make_unique<AlarmRegistry>();
  (void)book->configure(two_buses());
  KeptAlarms kept;
  std::map<AlarmKey, AlarmStatus> states;
  std::map<AlarmDevice, AlarmPause> maintenance;
  std::map<AlarmEventKind, int> events;
  std::uint32_t restarts = 0;
  for (int step = 0; step < 200'000; ++step) {
    const UtcTime now = after(step * 7s);
    const AlarmKey& alarm = alarms[pick(static_cast<std::uint32_t>(alarms.size()))];
    AlarmAction action{.by = pick(20) == 0 ? "" : "anna", .note = "seen"};
    action.alarm = alarm;
    action.kind = static_cast<AlarmActionKind>(pick(5));
    action.duration = Duration(1min) * static_cast<int>(pick(2000)) - 1min;
    switch (pick(8)) {
      case 0:
      case 1: (void)book->raise(alarm, 99, now, now); break;
      case 2:
      case 3: (void)book->clear(alarm, 50, now); break;
      case 4: (void)book->act(action, now); break;
      default: book->on_time("shop", now); break;
    }
    const AlarmRegistry::News news = book->take_news();
    for (const AlarmEvent& event : news.events) ++events[event.kind];
    for (const AlarmKey& each : news.to_keep) {
      states[each] = *book->find(each);
      states[each].suppressed = {};
    }
    for (const KeptMaintenance& each : news.maintenance) maintenance[each.device] = each.pause;
    for (const AlarmKey& each : alarms) {
      const AlarmStatus* status = book->find(each);
      if (status == nullptr) continue;
      const bool waits = status->stage == AlarmStage::kUnacknowledged ||
                         status->stage == AlarmStage::kAcknowledged;
      ASSERT_EQ(waits, status->active) << step << ' ' << status_text(*status);
      ASSERT_EQ(status->cleared_at.nanoseconds != 0,
                !status->active && status->raised_at.nanoseconds != 0);
      ASSERT_TRUE(!status->shelved.is_set() ||
                  status->shelved.until.nanoseconds - now.nanoseconds <= Duration(24h).count());
      ASSERT_TRUE(!status->suppressed.is_set() || !status->suppressed.by.empty());
    }
    if (pick(100) != 0) continue;
    ++restarts;
    kept = {};
    for (const auto& [each, status] : states) {
      kept.states.push_back({each, status});
      if (status.active) kept.active.push_back({each, status});
    }
    for (const auto& [device, pause] : maintenance) kept.maintenance.push_back({device, pause});
    auto restarted = std::make_unique<AlarmRegistry>();
    (void)restarted->configure(two_buses());
    ASSERT_TRUE(restarted->restore(kept, now).empty());
    for (const auto& [each, status] : states) {
      AlarmStatus counted = *book->find(each);
      counted.occurrences = restarted->find(each)->occurrences;  // this table does not keep them
      counted.chattering = false;
      ASSERT_EQ(*restarted->find(each), counted) << step << ' ' << to_text(each);
    }
    book = std::move(restarted);
    (void)book->take_news();
  }
  EXPECT_GT(restarts, 1000u);
  EXPECT_EQ(events.size(), 8u) << "each kind happens";
}

}  // namespace
}  // namespace fieldcast
