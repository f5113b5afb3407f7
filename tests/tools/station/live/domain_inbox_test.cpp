#include "tools/station/live/domain_inbox.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/tools/station/live/live_support.hpp"

namespace fieldcast::web {
namespace {

struct DomainInboxTest : ::testing::Test {
  std::atomic<int> wakes = 0;
  DomainInbox inbox{[this] { ++wakes; }};
  LiveModel model;
};

TEST_F(DomainInboxTest, ItsOwnerIsWokenOnceUntilItTakes) {
  inbox.on_channel(channel_of("oil"));
  inbox.on_sample(sample_of("oil", 1.0));
  EXPECT_EQ(wakes, 1);
  inbox.deliver(model, {});
  EXPECT_EQ(model.find(path_of("oil"))->last.value, Value(1.0));
  inbox.on_sample(sample_of("oil", 2.0));
  EXPECT_EQ(wakes, 2);
}

TEST_F(DomainInboxTest, TheNewestValueWins) {
  inbox.on_channel(channel_of("oil"));
  for (int i = 0; i < 1000; ++i) inbox.on_sample(sample_of("oil", 1.0 * i));
  inbox.deliver(model, {});
  EXPECT_EQ(model.find(path_of("oil"))->last.value, Value(999.0));
  EXPECT_EQ(model.version(), 1u);
  EXPECT_EQ(inbox.counters().overtaken, 999u);
}

TEST_F(DomainInboxTest, AChannelThatWentAndCameBackIsThere) {
  inbox.on_channel(channel_of("oil"));
  inbox.on_sample(sample_of("oil", 1.0));
  inbox.deliver(model, {});
  inbox.on_gone("shop", "press", "oil");
  inbox.on_channel(channel_of("oil"));
  inbox.deliver(model, {});
  EXPECT_FALSE(model.find(path_of("oil"))->gone);
  EXPECT_EQ(model.find(path_of("oil"))->last.quality, Quality::kUncertain) << "no value came since";
}

TEST_F(DomainInboxTest, AChannelThatCameAndWentIsRemoved) {
  inbox.on_channel(channel_of("oil"));
  inbox.on_sample(sample_of("oil", 1.0));
  inbox.deliver(model, {});
  inbox.on_sample(sample_of("oil", 2.0));
  inbox.on_gone("shop", "press", "oil");
  inbox.deliver(model, {});
  EXPECT_TRUE(model.find(path_of("oil"))->gone);
  EXPECT_EQ(model.count(), 0u);
}

TEST_F(DomainInboxTest, ObjectsComeToo) {
  inbox.put(bus_of("shop"));
  inbox.put(device_of("press", 1));
  inbox.put(live_alarm(
      StationAlarm{"shop", "press", "oil", LimitKind::kHigh, AlarmState::kActive, 81, {1}}));
  inbox.put(LiveSession{{"shop", "press", ProgramSessionState::kOpen, "anna", 1, 2, {1}}, "", {}});
  StationBridge bridge;
  bridge.bridge = "line-7";
  inbox.put(bridge);
  inbox.deliver(model, {});
  EXPECT_EQ(model.objects().all<StationBusStatus>().size(), 1u);
  EXPECT_EQ(model.objects().all<StationDeviceStatus>().size(), 1u);
  EXPECT_EQ(model.objects().all<LiveAlarm>().size(), 1u);
  EXPECT_EQ(model.objects().all<LiveSession>().size(), 1u);
  EXPECT_EQ(model.objects().all<StationBridge>().size(), 1u);
  inbox.remove(bus_of("shop"));
  inbox.remove(device_of("press", 1));
  inbox.remove(bridge);
  inbox.remove(live_alarm(
      StationAlarm{"shop", "press", "oil", LimitKind::kHigh, AlarmState::kActive, 81, {1}}));
  inbox.deliver(model, {});
  EXPECT_TRUE(model.objects().all<StationBusStatus>().empty());
  EXPECT_TRUE(model.objects().all<StationDeviceStatus>().empty());
  EXPECT_TRUE(model.objects().all<LiveAlarm>().empty());
  EXPECT_TRUE(model.objects().all<StationBridge>().empty());
}

TEST_F(DomainInboxTest, ThreadsBringWhatTheyHearAndNothingIsLost) {
  for (const char* name : {"a", "b"}) inbox.on_channel(channel_of(name));
  std::atomic<bool> done = false;
  std::thread first([&] {
    for (int i = 0; i <= 20'000; ++i) inbox.on_sample(sample_of("a", 1.0 * i));
  });
  std::thread second([&] {
    for (int i = 0; i <= 20'000; ++i) inbox.on_sample(sample_of("b", 1.0 * i));
    done = true;
  });
  while (!done) inbox.deliver(model, {});
  first.join();
  second.join();
  inbox.deliver(model, {});
  EXPECT_EQ(model.find(path_of("a"))->last.value, Value(20'000.0));
  EXPECT_EQ(model.find(path_of("b"))->last.value, Value(20'000.0));
}

}  // namespace
}  // namespace fieldcast::web
