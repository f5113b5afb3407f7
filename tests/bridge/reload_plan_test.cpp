#include "bridge/reload_plan.hpp"

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

TEST(ReloadPlan, AnotherStoreRestartsEverything) {
  auto wanted = bridge({bus("a")});
  wanted.store = StoreSpec{"plant.db"};
  EXPECT_TRUE(plan_reload(bridge({bus("a")}), wanted).whole_bridge);
}

TEST(ReloadPlan, OnlyTheChangedBusRestarts) {
  const auto plan = plan_reload(bridge({bus("a"), bus("b"), bus("c")}), bridge({bus("a"), bus("b", 2), bus("c")}));
  EXPECT_THAT(plan.stop, ElementsAre("b"));
  EXPECT_THAT(plan.start, ElementsAre("b"));
  EXPECT_THAT(plan.untouched, ElementsAre("a", "c"));
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
  EXPECT_TRUE(plan.whole_bridge);
  EXPECT_THAT(plan.stop, IsEmpty());
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

}  // namespace
}  // namespace fieldcast
