#include <gtest/gtest.h>

#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

AlarmAction acknowledge(const std::string& bus) {
  AlarmAction action;
  action.alarm = {bus, "d", "c0", LimitKind::kHigh};
  action.by = "anna";
  action.note = "seen";
  return action;
}

struct Agreeing {
  explicit Agreeing(const std::string& bus) {
    received.answer_action = [this](const AlarmAction& action) {
      Command asked;
      asked.requester = action.requester;
      asked.request_id = action.request_id;
      CommandResult result = done(asked);
      result.values.clear();
      link.complete(action.alarm.bus, result, both_clocks());
    };
    link.add_bus(bus_of(bus, 1));
    claim(link, {bus, bus + "-other"});  // so that actions for the other bus are sent
  }
  Received received;
  DdsLink link{loopback(), "test", received.handlers()};
};

TEST(DdsAlarmAction, GetsAResponseOnceAndSharesTheIdsOfCommands) {
  const std::string bus = bus_name("action");
  Agreeing bridge(bus);
  Collected<StationResult> results;
  Station station(loopback(), "operator");
  station.on_result([&](const StationResult& result) { results.add(result); });
  const auto result = station.execute(acknowledge(bus));
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_EQ(result->state, CommandState::kDone);
  EXPECT_EQ(result->bus, bus);
  ASSERT_EQ(bridge.received.actions.size(), 1u);
  const AlarmAction taken = bridge.received.actions.all()[0];
  EXPECT_EQ(taken.alarm, acknowledge(bus).alarm);
  EXPECT_EQ(taken.by + ": " + taken.note, "anna: seen");
  EXPECT_EQ(taken.requester, station.requester());
  const auto second = station.send(acknowledge(bus));
  ASSERT_TRUE(second);
  EXPECT_EQ(*second, result->request_id + 1);
  ASSERT_TRUE(eventually([&] { return results.size() >= 2; }));
  EXPECT_EQ(results.size(), 2u);
}

TEST(DdsAlarmAction, AThousandAllGetResponses) {
  const std::string bus = bus_name("many-actions");
  Agreeing bridge(bus);
  Collected<std::uint64_t> ids;
  Station station(loopback(), "operator");
  station.on_result([&](const StationResult& result) { ids.add(result.request_id); });
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(station.send(acknowledge(bus)));
  ASSERT_TRUE(eventually([&] { return ids.size() >= 1000; })) << ids.size() << " results came";
  EXPECT_EQ(ids.size(), 1000u);
}

TEST(DdsAlarmAction, WhatDoesNotFitIsNotSentAndOtherBusesAreLeftToTheirBridges) {
  const std::string bus = bus_name("misfit");
  Agreeing bridge(bus);
  Station station(loopback(), "operator");
  AlarmAction action = acknowledge(bus);
  action.note.assign(257, 'x');
  const auto result = station.execute(action);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error(), StationFault::kNotSent);
  const auto other = station.execute(acknowledge(bus + "-other"), 3s, 300ms);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error(), StationFault::kNoResult);
  EXPECT_EQ(bridge.received.actions.size(), 0u);
}

TEST(DdsAlarmStatus, ReachesLateStationsAndGoesAlone) {
  const std::string bus = bus_name("alarm-status");
  Agreeing bridge(bus);
  const AlarmKey high{bus, "d", "c0", LimitKind::kHigh}, low{bus, "d", "c0", LimitKind::kLow};
  AlarmStatus status;
  status.stage = AlarmStage::kAcknowledged;
  status.active = true;
  status.acknowledged = {"anna", "seen", {5}};
  bridge.link.report(high, status);
  bridge.link.report(low, {});
  bridge.link.report({bus + "-other", "d", "c0", LimitKind::kLow}, {});  // not a bus of this bridge
  Collected<StationAlarmStatus> came, gone;
  Station station(loopback(), "watcher");
  station.subscribe_alarm_status([&](const StationAlarmStatus& known) { came.add(known); },
                                 [&](const StationAlarmStatus& last) { gone.add(last); });
  ASSERT_TRUE(eventually([&] { return came.size() >= 2; }));
  for (const StationAlarmStatus& known : came.all()) {
    EXPECT_EQ(known.status, known.alarm == high ? status : AlarmStatus{});
  }
  bridge.link.forget(low);
  ASSERT_TRUE(eventually([&] { return gone.size() >= 1; }));
  EXPECT_EQ(gone.all()[0].alarm, low);
  bridge.link.remove_bus(bus);
  ASSERT_TRUE(eventually([&] { return gone.size() >= 2; }));
  EXPECT_EQ(gone.all()[1].alarm, high);
  EXPECT_EQ(came.size(), 2u);
}

}  // namespace
}  // namespace fieldcast::testing
