#include "bridge/buses/reload_plan.hpp"

#include <gmock/gmock.h>

namespace fieldcast {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

BusSpec bus(const std::string& name, std::uint16_t address = 1) {
  BusSpec made;
  made.name = name;
  made.port = SerialPortSpec{"/dev/" + name};
  DeviceSpec device;
  device.name = "d";
  device.link.address = address;
  made.devices.push_back(device);
  return made;
}

BridgeSpec bridge(std::vector<BusSpec> buses) {
  BridgeSpec made;
  made.name = "line";
  made.buses = std::move(buses);
  return made;
}

TEST(ReloadPlan, TheSameFileChangesNothing) {
  const auto plan = plan_reload(bridge({bus("a"), bus("b")}), bridge({bus("a"), bus("b")}));
  EXPECT_TRUE(plan.nothing());
  EXPECT_THAT(plan.untouched, ElementsAre("a", "b"));
}

TEST(ReloadPlan, AnotherOrderChangesNothing) {
  EXPECT_TRUE(plan_reload(bridge({bus("a"), bus("b")}), bridge({bus("b"), bus("a")})).nothing());
}

TEST(ReloadPlan, AnotherProgrammingPortLeavesTheBusesAlone) {
  BridgeSpec wanted = bridge({bus("a")});
  wanted.program.engineers.emplace().listen = {"127.0.0.1", 4950};
  const auto plan = plan_reload(bridge({bus("a")}), wanted);
  EXPECT_TRUE(plan.program);
  EXPECT_FALSE(plan.nothing());
  EXPECT_THAT(plan.untouched, ElementsAre("a"));
}

TEST(ReloadPlan, AnotherAddressOfTheMetricsLeavesTheBusesAlone) {
  BridgeSpec wanted = bridge({bus("a")});
  wanted.metrics = MetricsSpec{{"127.0.0.1", 9464}};
  const auto plan = plan_reload(bridge({bus("a")}), wanted);
  EXPECT_TRUE(plan.metrics);
  EXPECT_FALSE(plan.nothing());
  EXPECT_FALSE(plan.program);
  EXPECT_THAT(plan.untouched, ElementsAre("a"));
}

TEST(ReloadPlan, AnotherStoreRestartsEverything) {
  auto wanted = bridge({bus("a")});
  wanted.store = StoreSpec{"plant.db"};
  EXPECT_THAT(plan_reload(bridge({bus("a")}), wanted).whole_bridge,
              ElementsAre("it has a store now"));
  EXPECT_THAT(plan_reload(wanted, bridge({bus("a")})).whole_bridge,
              ElementsAre("it has no store any more"));
  auto other = wanted;
  other.store->address = "other.db";
  EXPECT_THAT(plan_reload(wanted, other).whole_bridge, ElementsAre("its store has changed"));
}

TEST(ReloadPlan, ARenamedBridgeRestartsEverything) {
  BridgeSpec named = bridge({bus("a")}), wanted = named;
  named.name = "line-1";
  wanted.name = "line-2";
  EXPECT_THAT(plan_reload(named, wanted).whole_bridge,
              ElementsAre("the bridge line-1 is now called line-2"));
}

TEST(ReloadPlan, OnlyTheChangedBusRestarts) {
  const auto plan = plan_reload(bridge({bus("a"), bus("b"), bus("c")}),
                                bridge({bus("a"), bus("b", 2), bus("c")}));
  EXPECT_THAT(plan.stop, ElementsAre("b"));
  EXPECT_THAT(plan.start, ElementsAre("b"));
  EXPECT_THAT(plan.untouched, ElementsAre("a", "c"));
}

TEST(ReloadPlan, ACaptureBeginsAndEndsWhileItsBusRuns) {
  BridgeSpec wanted = bridge({bus("a"), bus("b")});
  wanted.buses[1].capture = CaptureSpec{"/tmp"};
  const auto plan = plan_reload(bridge({bus("a"), bus("b")}), wanted);
  EXPECT_THAT(plan.stop, IsEmpty());
  EXPECT_THAT(plan.untouched, ElementsAre("a", "b"));
}

TEST(ReloadPlan, NewAndRemovedBusesStartAndStop) {
  const auto plan = plan_reload(bridge({bus("a"), bus("b")}), bridge({bus("b"), bus("c")}));
  EXPECT_THAT(plan.stop, ElementsAre("a"));
  EXPECT_THAT(plan.start, ElementsAre("c"));
}

TEST(ReloadPlan, ARenamedBusIsAnotherBus) {
  const auto plan = plan_reload(bridge({bus("a")}), bridge({bus("z")}));
  EXPECT_THAT(plan.stop, ElementsAre("a"));
  EXPECT_THAT(plan.start, ElementsAre("z"));
}

TEST(ReloadPlan, OtherDdsSettingsRestartEverything) {
  BridgeSpec wanted = bridge({bus("a")});
  wanted.dds.domain = 7;
  const auto plan = plan_reload(bridge({bus("a")}), wanted);
  EXPECT_THAT(plan.whole_bridge, ElementsAre("its DDS domain is 7, it was 0"));
  EXPECT_THAT(plan.stop, IsEmpty());
  wanted = bridge({bus("a")});
  wanted.dds.partition = "north";
  EXPECT_THAT(plan_reload(bridge({bus("a")}), wanted).whole_bridge,
              ElementsAre("its DDS settings have changed"));
}

TEST(ReloadPlan, AnotherLogLevelTouchesNoBus) {
  BridgeSpec wanted = bridge({bus("a")});
  wanted.log.level = LogLevel::kDebug;
  EXPECT_TRUE(plan_reload(bridge({bus("a")}), wanted).nothing());
}

TEST(ReloadPlan, EveryFieldOfAChannelCounts) {
  BusSpec changed = bus("a");
  BusSpec plain = bus("a");
  plain.devices[0].channels.emplace_back();
  changed.devices[0].channels.emplace_back().deadband = 0.5;
  EXPECT_THAT(plan_reload(bridge({plain}), bridge({changed})).start, ElementsAre("a"));
}

BusSpec dial_in_bus(const std::string& name, const std::string& number) {
  BusSpec made = bus(name);
  made.port = DialInPortSpec{number, std::nullopt};
  return made;
}

TEST(ReloadPlan, WhoProgramsADeviceThatItWouldTakeAwayIsWaitedFor) {
  const auto numbers = [](const std::vector<program::LeasedDevice>& leased) {
    std::vector<std::string> all;
    for (const auto& device : leased) all.push_back(device.number);
    return all;
  };
  const std::vector<program::LeasedDevice> leased{
      {"P1", "a", "d", "anna"}, {"P2", "b", "d", "ben"}, {"17", "dial-in", "17", "cem"}};
  const BridgeSpec running = bridge({bus("a"), bus("b")});
  const auto disturbed = [&](const BridgeSpec& wanted) {
    return numbers(disturbed_by(plan_reload(running, wanted), wanted, leased));
  };
  EXPECT_THAT(disturbed(running), IsEmpty());
  EXPECT_THAT(disturbed(bridge({bus("a"), bus("b", 2)})), ElementsAre("P2"));
  EXPECT_THAT(disturbed(bridge({bus("a")})), ElementsAre("P2"));
  EXPECT_THAT(disturbed(bridge({bus("a"), bus("b"), bus("c")})), IsEmpty());
  EXPECT_THAT(disturbed(bridge({bus("a"), bus("b"), dial_in_bus("c", "17")})), ElementsAre("17"));
  EXPECT_THAT(disturbed(bridge({bus("a"), bus("b"), dial_in_bus("c", "18")})), IsEmpty());
  BridgeSpec wanted = running;
  wanted.program.engineers.emplace();
  EXPECT_THAT(disturbed(wanted), ElementsAre("P1", "P2", "17"));
  wanted = running;
  wanted.dds.domain = 7;
  EXPECT_THAT(disturbed(wanted), ElementsAre("P1", "P2", "17"));
}

TEST(ReloadPlan, IsReportedInOneLine) {
  const BridgeSpec running = bridge({bus("a"), bus("b"), bus("c")});
  EXPECT_EQ(to_text(plan_reload(running, bridge({bus("a"), bus("b", 2), bus("d")}))),
            "reloaded: 2 buses stopped (b, c), 2 started (b, d), 1 untouched");
  EXPECT_EQ(to_text(plan_reload(running, running)),
            "reloaded: 0 buses stopped, 0 started, 3 untouched");
}

TEST(EndOfAlarm, NamesTheChannelByItsIndexOnTheRunningBus) {
  BridgeSpec running = bridge({bus("a"), bus("b")});
  DeviceSpec& device = running.buses[1].devices[0];
  device.channels.resize(2);
  device.channels[0].name = "level";
  device.channels[1].name = "flow";
  AlarmRecord alarm;
  alarm.bus = "b";
  alarm.device = "d";
  alarm.channel = "flow";
  alarm.limit = "high";
  const auto change = end_of_alarm(running, alarm, Instant{std::chrono::seconds{5}});
  ASSERT_TRUE(change);
  EXPECT_EQ(change->channel, 1u);
  EXPECT_EQ(change->limit, LimitKind::kHigh);
  EXPECT_EQ(change->state, AlarmState::kClear);
  EXPECT_EQ(change->since, Instant{std::chrono::seconds{5}});
  alarm.channel = "speed";
  EXPECT_FALSE(end_of_alarm(running, alarm, {})) << "a channel that does not run";
  alarm.bus = "c";
  EXPECT_FALSE(end_of_alarm(running, alarm, {})) << "a bus that does not run";
}

}  // namespace
}  // namespace fieldcast
