#include "tools/station/model/live_objects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/station/live/live_support.hpp"

namespace fieldcast::web {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kEverything = 100'000;

std::vector<std::string> texts(const LiveObjects::News& news) {
  std::vector<std::string> found;
  for (const auto& message : news.messages) found.push_back(*message);
  return found;
}

LiveAlarm alarm_of(const std::string& channel, bool active) {
  return live_alarm({"shop",
                     "press",
                     channel,
                     LimitKind::kHighHigh,
                     active ? AlarmState::kActive : AlarmState::kClear,
                     95,
                     {5'000'000}});
}

TEST(LiveObjects, AMessageIsMadeOnceForAll) {
  LiveObjects objects;
  objects.put(bus_of("shop"));
  const auto one = objects.since(0, kEverything), other = objects.since(0, kEverything);
  ASSERT_EQ(one.messages.size(), 1u);
  EXPECT_EQ(one.messages[0], other.messages[0]);
  EXPECT_THAT(*one.messages[0], HasSubstr(R"({"kind":"bus","bus":"shop","bridge":"line-7",)"));
}

LiveSession session_of(std::int64_t since, std::uint64_t bytes) {
  return {{"shop", "press", ProgramSessionState::kOpen, "anna", bytes, 0, {since}}, "", {}};
}

TEST(LiveObjects, ASessionAndItsLastRequestAreOneObject) {
  LiveObjects objects;
  const LiveSession request = live_session(ProgramRequestReport{"shop", "press", "RD", {20}});
  const auto live = [&] { return *objects.all<LiveSession>().at(0); };
  objects.put(request);  // the two topics have no order
  objects.put(session_of(10, 1));
  EXPECT_EQ(live().request, "RD");
  objects.put(session_of(10, 2));
  EXPECT_EQ(live().request, "RD");
  EXPECT_EQ(live().session.bytes_to_device, 2u);
  objects.put(live_session(ProgramRequestReport{"shop", "press", "WD", {21}}));
  EXPECT_EQ(live().request, "WD");
  EXPECT_EQ(live().session.who, "anna");
  objects.put(session_of(30, 0));  // the next session
  EXPECT_EQ(live().request, "");
  objects.put(request);  // late
  EXPECT_EQ(live().request, "");
  EXPECT_EQ(objects.all<LiveSession>().size(), 1u);
}

TEST(LiveObjects, NewestOfEachComesOnce) {
  LiveObjects objects;
  objects.put(bus_of("shop"));
  objects.put(bus_of("hall"));
  const std::uint64_t seen = objects.version();
  objects.put(bus_of("shop"));
  objects.put(bus_of("shop"));
  EXPECT_EQ(objects.since(seen, kEverything).messages.size(), 1u);
  EXPECT_EQ(objects.since(0, kEverything).messages.size(), 2u);
}

TEST(LiveObjects, ALimitCutsAndTheRestFollows) {
  LiveObjects objects;
  for (const char* name : {"a", "b", "c"}) objects.put(bus_of(name));
  const auto first = objects.since(0, 2);
  EXPECT_EQ(first.messages.size(), 2u);
  EXPECT_THAT(texts(objects.since(first.version, 2)), ElementsAre(HasSubstr(R"("bus":"c")")));
}

TEST(LiveObjects, ARemovedOneIsReportedToThoseWhoSawIt) {
  LiveObjects objects;
  objects.put(bus_of("shop"));
  objects.put(device_of("press", 1));
  const std::uint64_t seen = objects.version();
  objects.remove(bus_of("shop"));
  objects.remove(device_of("press", 1));
  EXPECT_THAT(texts(objects.since(seen, kEverything)),
              ElementsAre(R"({"kind":"bus_gone","bus":"shop"})",
                          R"({"kind":"device_gone","bus":"shop","device":"press"})"));
  EXPECT_THAT(objects.since(0, kEverything).messages, IsEmpty());
  EXPECT_THAT(objects.all<StationBusStatus>(), IsEmpty());
}

TEST(LiveObjects, AnInterestAndADescriptionEndWithAMessage) {
  LiveObjects objects;
  const Interest interest{"panel", "shop/*", std::chrono::milliseconds{500}};
  const StationDeviceDescription about{.bus = "shop", .device = "press"};
  objects.put(interest);
  objects.put(about);
  EXPECT_EQ(objects.description("shop", "press")->bus, "shop");
  EXPECT_EQ(objects.description("shop", "lathe"), nullptr);
  const auto news = objects.since(0, 10);
  ASSERT_EQ(news.messages.size(), 2U);
  EXPECT_EQ(*news.messages[0],
            R"({"kind":"interest","station":"panel","pattern":"shop/*","refresh_ms":500})");
  objects.remove(interest);
  objects.remove(about);
  EXPECT_EQ(objects.description("shop", "press"), nullptr);
  const auto ends = objects.since(news.version, 10);
  ASSERT_EQ(ends.messages.size(), 2U);
  EXPECT_NE(ends.messages[0]->find("interest_gone"), std::string::npos);
  EXPECT_EQ(*ends.messages[1], R"({"kind":"description_gone","bus":"shop","device":"press"})");
}

TEST(LiveObjects, AnotherPlanIsReportedAndTheSameOneIsNot) {
  LiveObjects objects;
  EXPECT_EQ(objects.read_plan("shop"), nullptr);
  objects.put(plan_of("shop"));
  EXPECT_THAT(texts(objects.since(0, kEverything)), ElementsAre(R"({"kind":"plan","bus":"shop"})"));
  std::uint64_t seen = objects.version();
  objects.put(plan_of("shop"));
  EXPECT_EQ(objects.version(), seen);
  objects.put(plan_of("shop", 0.5));
  EXPECT_EQ(objects.since(seen, kEverything).messages.size(), 1u);
  EXPECT_EQ(objects.read_plan("shop")->plan.load, 0.5);
  seen = objects.version();
  objects.remove(plan_of("shop"));
  EXPECT_EQ(objects.read_plan("shop"), nullptr);
  EXPECT_THAT(texts(objects.since(seen, kEverything)),
              ElementsAre(R"({"kind":"plan","bus":"shop"})"));
}

TEST(LiveObjects, ADeviceThatOnlyCountsIsReportedEveryTwoSeconds) {
  LiveObjects objects;
  objects.put(device_of("press", 1));
  std::uint64_t seen = objects.version();
  objects.put(device_of("press", 2));
  EXPECT_EQ(objects.version(), seen);
  EXPECT_EQ(objects.all<StationDeviceStatus>().at(0)->reported_at.nanoseconds, 2'000'000'000);
  objects.put(device_of("press", 3));
  EXPECT_GT(objects.version(), seen);
  seen = objects.version();
  objects.put(device_of("press", 4, DeviceState::kOffline));
  EXPECT_GT(objects.version(), seen) << "a change of state is told at once";
}

TEST(LiveObjects, AnAlarmThatIsClearIsReportedOnceAndRemoved) {
  LiveObjects objects;
  objects.put(alarm_of("oil", false));
  EXPECT_EQ(objects.version(), 0u) << "it was never active";
  objects.put(alarm_of("oil", true));
  EXPECT_EQ(objects.all<LiveAlarm>().size(), 1u);
  EXPECT_EQ(objects.all<LiveAlarm>()[0]->priority, "high");
  const std::uint64_t seen = objects.version();
  objects.put(alarm_of("oil", false));
  EXPECT_THAT(objects.all<LiveAlarm>(), IsEmpty());
  EXPECT_THAT(texts(objects.since(seen, kEverything)),
              ElementsAre(HasSubstr(R"("state":"clear")")));
}

TEST(LiveObjects, UserActionsOnAnAlarmStay) {
  LiveObjects objects;
  StationAlarmStatus status;
  status.alarm = {"shop", "press", "oil", LimitKind::kHighHigh};
  status.status = {.priority = AlarmPriority::kCritical,
                   .stage = AlarmStage::kAcknowledged,
                   .active = true,
                   .value = 95,
                   .raised_at = {5'000'000},
                   .acknowledged = {"anna", "fan is ordered", {6'000'000}}};
  objects.put(alarm_of("oil", true));
  objects.put(live_alarm(status));
  objects.put(alarm_of("oil", true));
  ASSERT_EQ(objects.all<LiveAlarm>().size(), 1u);
  const LiveAlarm& alarm = *objects.all<LiveAlarm>()[0];
  EXPECT_EQ(alarm.state, "acknowledged");
  EXPECT_EQ(alarm.priority, "critical");
  EXPECT_EQ(alarm.acknowledged_by, "anna");
  objects.put(alarm_of("oil", false));
  EXPECT_EQ(objects.all<LiveAlarm>().size(), 1u) << "its own status says when it is clear";
  status.status.stage = AlarmStage::kClear;
  status.status.active = false;
  status.status.shelved.until = {9'000'000};
  objects.put(live_alarm(status));
  EXPECT_EQ(objects.all<LiveAlarm>().size(), 1u) << "it is shelved";
  status.status.shelved = {};
  objects.put(live_alarm(status));
  EXPECT_THAT(objects.all<LiveAlarm>(), IsEmpty());
}

TEST(LiveObjects, WhoMissedARemovalIsNotified) {
  LiveObjects objects;
  objects.put(bus_of("bus"));
  const std::uint64_t seen = objects.version();
  for (std::size_t i = 0; i <= LiveObjects::kMaxGone; ++i) {
    const std::string name = "bus-" + std::to_string(i);
    objects.put(bus_of(name));
    objects.remove(bus_of(name));
  }
  EXPECT_TRUE(objects.since(seen, kEverything).lost);
  EXPECT_FALSE(objects.since(0, kEverything).lost);
  EXPECT_FALSE(objects.since(objects.version(), kEverything).lost);
}

TEST(LiveObjects, BeyondTheLimitObjectsAreLeftOut) {
  LiveObjects objects;
  for (std::size_t i = 0; i <= LiveObjects::kMaxObjects; ++i)
    objects.put(bus_of("bus-" + std::to_string(i)));
  EXPECT_EQ(objects.refused(), 1u);
  objects.put(bus_of("bus-0"));
  EXPECT_EQ(objects.refused(), 1u);
}

}  // namespace
}  // namespace fieldcast::web
