#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

TEST(DdsLink, StatusArrivesAndGoesWithItsBus) {
  const std::string bus = bus_name("status");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 1));
  Collected<StationBusStatus> buses;
  Collected<StationDeviceStatus> devices;
  Station station(loopback(), "watcher");
  station.subscribe_bus_status([&](const StationBusStatus& status) { buses.add(status); });
  station.subscribe_device_status([&](const StationDeviceStatus& status) { devices.add(status); });
  BusReport report;
  report.state = BusState::kRunning;
  report.causes.add(Cause::kForeign);
  link.report(bus, report, {5});
  DeviceReport device;
  device.refused = {"holding:7"};
  link.report(bus, "d", device, {6});
  ASSERT_TRUE(eventually([&] { return buses.size() >= 1 && devices.size() >= 1; }));
  EXPECT_EQ(buses.all()[0].bus, bus);
  EXPECT_EQ(buses.all()[0].report.state, BusState::kRunning);
  EXPECT_EQ(buses.all()[0].causes.begin()->first, to_name(Cause::kForeign));
  EXPECT_EQ(devices.all()[0].report.refused, std::vector<std::string>{"holding:7"});
}

TEST(DdsLink, StatusReportsHowFarTheClockOfTheStationIsAhead) {
  const std::string bus = bus_name("clock");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 1));
  Collected<StationBusStatus> buses;
  Station station(loopback(), "watcher");
  station.subscribe_bus_status([&](const StationBusStatus& status) { buses.add(status); });
  const auto report_behind = [&](Duration by) {
    const std::size_t before = buses.size();
    link.report(bus, BusReport{}, {both_clocks().utc.nanoseconds - by.count()});
    return eventually([&] { return buses.size() > before; });
  };
  ASSERT_TRUE(report_behind(1h));
  EXPECT_EQ(buses.all().back().clock_ahead, std::nullopt);
  ASSERT_TRUE(eventually(
      [&] { return report_behind(10s) && buses.all().back().clock_ahead.value_or(0s) >= 10s; }));
  EXPECT_LT(*buses.all().back().clock_ahead, 1h);
}

TEST(DdsLink, ADescriptionReachesLateStationsAndGoesWithItsBus) {
  const std::string bus = bus_name("description");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  BusSpec spec = bus_of(bus, 2);
  spec.devices[0].protocol = "modbus-rtu";
  spec.devices[0].channels[1].digits = 2;
  link.add_bus(spec);
  Collected<StationDeviceDescription> came, gone;
  Station station(loopback(), "watcher");
  station.subscribe<StationDeviceDescription>(
      [&](const StationDeviceDescription& each) { came.add(each); },
      [&](const StationDeviceDescription& each) { gone.add(each); });
  ASSERT_TRUE(eventually([&] { return came.size() == 1; }));
  EXPECT_EQ(came.all()[0].bus + "/" + came.all()[0].device, bus + "/d");
  EXPECT_EQ(came.all()[0].protocol, "modbus-rtu");
  EXPECT_EQ(came.all()[0].digits.at("c1"), (ShownDigits{2, true}));
  link.publish_again(bus);
  EXPECT_TRUE(eventually([&] { return came.size() == 2; }));
  link.remove_bus(bus);
  EXPECT_TRUE(eventually([&] { return gone.size() == 1; }));
}

TEST(Station, SeesWhichStationAsksForWhichChannels) {
  const std::string pattern = bus_name("asked") + "/*/*";
  Collected<Interest> came, gone;
  Station watcher(loopback(), "watcher");
  watcher.subscribe_interests([&](const Interest& each) { came.add(each); },
                              [&](const Interest& each) { gone.add(each); });
  auto panel = std::make_optional<Station>(loopback(), "panel");
  panel->declare_interest(pattern, 500ms);
  ASSERT_TRUE(eventually([&] { return came.size() == 1; }));
  EXPECT_NE(came.all()[0].station.find("panel"), std::string::npos) << came.all()[0].station;
  EXPECT_EQ(came.all()[0].pattern, pattern);
  EXPECT_EQ(came.all()[0].refresh, 500ms);
  panel->withdraw_interest(pattern);
  ASSERT_TRUE(eventually([&] { return gone.size() == 1; }));
  panel->declare_interest(pattern, 1s);
  ASSERT_TRUE(eventually([&] { return came.size() == 2; }));
  panel.reset();
  EXPECT_TRUE(eventually([&] { return gone.size() == 2; }));
}

TEST(DdsLink, APlanReachesLateStationsAndGoesWithItsBus) {
  const std::string bus = bus_name("plan");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 2));
  PlanReport plan{.load = 0.25, .slot = 100ms, .hyperperiod = 400ms};
  PlanReport::Point point{.area = "holding", .first = 7, .count = 1, .channels = {"c0"}};
  plan.groups.push_back({.device = "d", .points = std::vector(300, point)});
  link.report(bus, plan, {5});
  plan.groups = {{.device = "d", .period = 100ms, .points = {point}}};
  link.report(bus, plan, {6});
  Collected<StationReadPlan> plans;
  Collected<std::string> gone;
  Station station(loopback(), "watcher");
  station.subscribe_read_plans([&](const StationReadPlan& read) { plans.add(read); },
                               [&](const std::string& which) { gone.add(which); });
  ASSERT_TRUE(eventually([&] { return plans.size() >= 1; }));
  EXPECT_EQ(plans.all().back().bus, bus);
  EXPECT_EQ(plans.all().back().plan, plan);
  EXPECT_EQ(plans.all().back().in_force_since, UtcTime{6});
  EXPECT_EQ(gone.size(), 0U);
  link.remove_bus(bus);
  EXPECT_TRUE(eventually([&] { return gone.size() == 1; }));
}

TEST(DdsLink, APlanThatIsLongerThanTheFirstAllocationArrives) {
  const std::string bus = bus_name("long");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 2));
  PlanReport plan{.load = 0.25, .slot = 100ms, .hyperperiod = 400ms};
  const PlanReport::Point point{.area = "holding", .first = 7, .count = 1, .channels = {"c0"}};
  plan.groups = std::vector(100, PlanReport::Group{.device = "d", .points = {point, point}});
  link.report(bus, plan, {5});
  Collected<StationReadPlan> plans;
  Station station(loopback(), "watcher");
  station.subscribe_read_plans([&](const StationReadPlan& read) { plans.add(read); });
  ASSERT_TRUE(eventually([&] { return plans.size() >= 1; }));
  EXPECT_EQ(plans.all().back().plan, plan);
}

TEST(DdsLink, AnAlarmOfEveryLimitReachesLateStationsAndGoesWithItsBus) {
  const std::string bus = bus_name("alarms");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 2));
  const UtcMapping clock = both_clocks();
  link.report(bus, AlarmChange{1, LimitKind::kHigh, AlarmState::kActive, 90.5, clock.instant},
              clock);
  link.report(bus, AlarmChange{1, LimitKind::kHighHigh, AlarmState::kActive, 99, clock.instant},
              clock);
  link.report(bus, AlarmChange{1, LimitKind::kHighHigh, AlarmState::kClear, 91, clock.instant + 1s},
              clock);
  Collected<StationAlarm> alarms, gone;
  Station station(loopback(), "watcher");
  station.subscribe_alarms([&](const StationAlarm& alarm) { alarms.add(alarm); },
                           [&](const StationAlarm& last) { gone.add(last); });
  ASSERT_TRUE(eventually([&] { return alarms.size() >= 2; })) << alarms.size() << " alarms came";
  std::map<LimitKind, StationAlarm> last;
  for (const StationAlarm& alarm : alarms.all()) last[alarm.limit] = alarm;
  EXPECT_EQ(last[LimitKind::kHigh].state, AlarmState::kActive);
  EXPECT_EQ(last[LimitKind::kHigh].value, 90.5);
  EXPECT_EQ(last[LimitKind::kHigh].since, clock.utc);
  EXPECT_EQ(last[LimitKind::kHigh].bus + '/' + last[LimitKind::kHigh].device, bus + "/d");
  EXPECT_EQ(last[LimitKind::kHigh].channel, "c1");
  EXPECT_EQ(last[LimitKind::kHighHigh].state, AlarmState::kClear);
  link.remove_bus(bus);
  EXPECT_TRUE(eventually([&] { return gone.size() >= 2; })) << gone.size() << " alarms went";
}

// Includes readers of other vendors, and readers that join while others read.
TEST(DdsLink, ReportsEachReaderOfSamplesThatComesAndOfRequestsForSnapshots) {
  const std::string bus = bus_name("readers");
  Received received;
  DdsLink::Handlers handlers = received.handlers();
  std::atomic<int> told{0};
  handlers.on_readers = [&] { ++told; };
  DdsLink link(loopback(), "test", std::move(handlers));
  link.add_bus(bus_of(bus, 1));
  link.publish(bus, std::vector{good(0, 0.5)}, both_clocks());
  Domain other(loopback(), "other", nullptr);
  for (int readers = 0; readers < 2; ++readers) {
    const int before = told;
    Collected<idl::Sample> samples;
    Taker<idl::Sample> taker([&](const idl::Sample& sample, const auto&) { samples.add(sample); });
    dds::DataReader* const reader =
        other.reader(kSampleTopic, &taker, dds::StatusMask::data_available());
    EXPECT_TRUE(eventually([&] { return told > before; }));
    EXPECT_TRUE(eventually([&] { return samples.size() > 0; }));
    other.remove(reader);
  }
  const int before = told;
  idl::SnapshotRequest request;
  request.bus() = bus;
  dds::DataWriter* const requests = other.writer(kSnapshotRequestTopic, "other");
  EXPECT_TRUE(eventually([&] {
    requests->write(&request);
    return told > before;
  }));
}

TEST(DdsLink, InterestsAreReceivedAndEndWhenWithdrawnOrTheirStationGoes) {
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  const std::string name = bus_name("interested");
  auto station = std::make_unique<Station>(loopback(), name);
  station->declare_interest("a/*/*", 200ms);
  station->declare_interest("b/*/*", 300ms);
  const auto of = [&](const std::string& pattern) {
    std::vector<std::optional<Duration>> seen;
    for (const Interest& interest : received.interests.all()) {
      if (interest.station.starts_with(name) && interest.pattern == pattern)
        seen.push_back(interest.refresh);
    }
    return seen;
  };
  using Refreshes = std::vector<std::optional<Duration>>;
  ASSERT_TRUE(eventually(
      [&] { return of("a/*/*") == Refreshes{200ms} && of("b/*/*") == Refreshes{300ms}; }));
  station->withdraw_interest("a/*/*");
  EXPECT_TRUE(eventually([&] { return of("a/*/*") == Refreshes{200ms, std::nullopt}; }));
  station.reset();
  EXPECT_TRUE(eventually([&] {
    return of("b/*/*") == Refreshes{300ms, std::nullopt};
  })) << "the station has left";
}

// More than the reader holds, but no station exceeds its own limit.
TEST(DdsLink, AFloodOfInterestsIsRefusedWithALineAndTheBridgeGoesOn) {
  constexpr int kEach = 2500;
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  const std::string bus = bus_name("flooded");
  link.add_bus(bus_of(bus, 1));
  Station first(loopback(), bus_name("first")), second(loopback(), bus_name("second"));
  for (int i = 0; i < kEach; ++i) first.declare_interest("a/*/" + std::to_string(i), 200ms);
  ASSERT_TRUE(eventually([&] { return received.interests.size() == kEach; }))
      << received.interests.size();
  for (int i = 0; i < kEach; ++i) second.declare_interest("b/*/" + std::to_string(i), 200ms);
  EXPECT_TRUE(eventually(
      [&] { return received.problems.size() >= 1 && received.interests.size() >= kMaxInterests; }));
  EXPECT_EQ(received.interests.size(), static_cast<std::size_t>(kMaxInterests));
  std::string problems;
  for (const std::string& problem : received.problems.all()) problems += problem + '\n';
  EXPECT_THAT(problems, ::testing::HasSubstr("nterest"));
  EXPECT_LE(received.problems.size(), 5u) << problems;
  // Known interests still work: a withdrawn one makes room.
  first.withdraw_interest("a/*/0");
  EXPECT_TRUE(eventually(
      [&] { return received.interests.size() > static_cast<std::size_t>(kMaxInterests); }));
}

TEST(WriteOnlyChannel, AcquiredWhileNobodyReadIsGivenToTheFirstReader) {
  const std::string bus = bus_name("write-only");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  BusSpec spec = bus_of(bus, 3);
  spec.devices[0].channels[1].access = Access::kWriteOnly;
  spec.devices[0].channels[2].access = Access::kWriteOnly;
  link.add_bus(spec);
  link.publish(bus, std::vector{good(0, 0.5), good(1, 1.5)}, both_clocks());

  Collected<StationSample> samples;
  Station station(loopback(), "late");
  station.subscribe_samples([&](const StationSample& sample) { samples.add(sample); }, {},
                            {.one_by_one = true});
  ASSERT_TRUE(eventually([&] { return samples.size() == 2; }))
      << samples.size() << " of the two channels that have a value came";
  link.publish(bus, std::vector{good(1, 2.5, 2)}, both_clocks());
  ASSERT_TRUE(eventually([&] { return samples.size() == 3; }));
  EXPECT_EQ(samples.all().back().channel, "c1");
  EXPECT_EQ(samples.all().back().value, Value{2.5});
}

}  // namespace
}  // namespace fieldcast::testing
