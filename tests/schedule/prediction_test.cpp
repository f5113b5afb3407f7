#include "core/schedule/prediction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "core/schedule/bus_plan.hpp"
#include "core/schedule/bus_schedule.hpp"
#include "core/schedule/overload.hpp"
#include "core/schedule/planned_times.hpp"
#include "tests/dispatch/virtual_wire.hpp"
#include "tests/plan/maps.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::kFakeProtocol;
using testing::HasSubstr;
using testing::Not;

test::Map two_groups() {
  test::Map map;
  for (std::uint32_t i = 0; i < 5; ++i) map.push_back({1, 2 * i, 0.5});
  for (std::uint32_t i = 0; i < 5; ++i) map.push_back({2, 2 * i, 2.0});
  return map;
}

TEST(Prediction, LightPlanIsFeasibleAndItsLoadIsWhatTheBlocksCost) {
  const ScheduleInput input = test::input_of(two_groups(), kFakeProtocol);
  const Prediction prediction = predict(input);
  EXPECT_TRUE(prediction.feasible);
  EXPECT_EQ(prediction.stretch, 1.0);
  EXPECT_EQ(prediction.missed, 0u);
  EXPECT_GE(prediction.horizon, 60s);
  ASSERT_EQ(prediction.blocks.size(), 2u);
  double load = 0;
  for (const BlockForecast& block : prediction.blocks)
    load += block.per_second * to_seconds(block.cost);
  EXPECT_NEAR(load, prediction.load, 1e-6);
  EXPECT_NEAR(prediction.load, prediction.planned_load, 0.05 * prediction.planned_load);
  for (const PointForecast& point : prediction.points) {
    EXPECT_LE(point.worst_gap, point.refresh);
    EXPECT_GT(point.reads, 0u);
  }
  EXPECT_FALSE(prediction.remedies.stretch || prediction.remedies.baud ||
               !prediction.remedies.slower.empty());
}

TEST(Prediction, OverloadNamesConfigurationsThatWork) {
  const ScheduleInput input = test::input_of(test::random_map(2, 100), kFakeProtocol);
  const Prediction prediction = predict(input);
  ASSERT_FALSE(prediction.feasible);
  EXPECT_GT(prediction.planned_load, 1.0);
  EXPECT_GT(prediction.missed, 0u);

  ASSERT_TRUE(prediction.remedies.stretch);
  ScheduleInput slower = input;
  for (Point& point : slower.points)
    point.refresh = from_seconds(to_seconds(point.refresh) * *prediction.remedies.stretch);
  EXPECT_TRUE(predict(slower).feasible);

  ASSERT_TRUE(prediction.remedies.baud);
  EXPECT_GT(*prediction.remedies.baud, input.line.baud);

  ASSERT_FALSE(prediction.remedies.slower.empty());
  ScheduleInput some = input;
  for (const SlowerPoints& group : prediction.remedies.slower) {
    for (const PointIndex point : group.points) {
      EXPECT_EQ(some.points[point].refresh, group.from);
      some.points[point].refresh = group.to;
    }
  }
  EXPECT_TRUE(predict(some).feasible);
}

TEST(Prediction, DevicesAreSpreadOverLinesThatEachWork) {
  ScheduleInput input = test::input_of(two_groups(), kFakeProtocol);
  const DeviceTiming device = input.devices.front();
  input.devices.assign(6, device);
  input.points.clear();
  for (DeviceIndex d = 0; d < 6; ++d)
    input.points.push_back({.device = d, .range = {0, 0, 1}, .refresh = 55ms});
  const Prediction prediction = predict(input);
  ASSERT_FALSE(prediction.feasible);
  ASSERT_TRUE(prediction.remedies.buses);
  const std::size_t lines = *prediction.remedies.buses;
  EXPECT_GE(lines, 2u);
  ScheduleInput fullest = input;
  std::erase_if(fullest.points,
                [&](const Point& point) { return point.device >= (6 + lines - 1) / lines; });
  EXPECT_TRUE(predict(fullest).feasible);
  EXPECT_FALSE(predict(test::input_of(two_groups(), kFakeProtocol)).remedies.buses);
}

TEST(Prediction, ImpossiblePlanIsReportedInBoundedTime) {
  ScheduleInput input = test::input_of(two_groups(), kFakeProtocol);
  for (Point& point : input.points) point.refresh = 1ns;
  const Prediction prediction = predict(input, {.max_reads = 2000});
  EXPECT_FALSE(prediction.feasible);
  EXPECT_LE(prediction.reads, 2000u);
}

TEST(Prediction, RunsAsLongAsAsked) {
  const ScheduleInput input = test::input_of(two_groups(), kFakeProtocol);
  EXPECT_GE(predict(input).horizon, 60s);
  const Prediction brief = predict(input, {.horizon = 5s});
  EXPECT_GE(brief.horizon, 4s);
  EXPECT_LE(brief.horizon, 6s);
}

TEST(Remedies, WhereNothingHelpsThereAreNone) {
  ScheduleInput input = test::input_of(two_groups(), kFakeProtocol);
  input.points.push_back({.refresh = 1s, .mode = Mode::kOnDemand});
  const Remedies remedies = find_remedies(
      input, [](const ScheduleInput&) { return false; }, 1.5, Planner::kCyclic);
  EXPECT_FALSE(remedies.stretch || remedies.baud || remedies.buses);
  EXPECT_FALSE(remedies.longer_reads || remedies.no_pause);
  EXPECT_TRUE(remedies.slower.empty());
}

TEST(Remedies, WhatIsReadOnDemandIsNotReadLessOften) {
  ScheduleInput input = test::input_of(two_groups(), kFakeProtocol);
  const auto on_demand = static_cast<PointIndex>(input.points.size());
  input.points.push_back({.refresh = input.points.front().refresh, .mode = Mode::kOnDemand});
  const auto longer = [&](const ScheduleInput& other) {
    return other.points.front().refresh > input.points.front().refresh;
  };
  const Remedies remedies = find_remedies(input, longer, 1.5, Planner::kCyclic);
  ASSERT_EQ(remedies.slower.size(), 1u);
  EXPECT_EQ(remedies.slower[0].points.size(), 5u);
  for (const PointIndex point : remedies.slower[0].points) EXPECT_NE(point, on_demand);
}

TEST(Remedies, AGapThatMayNotBeBridgedIsALimit) {
  ScheduleInput input = test::input_of(two_groups(), kFakeProtocol);
  const auto without = [](const ScheduleInput& other) { return !other.devices[0].max_gap; };
  input.devices[0].max_gap = 0;
  EXPECT_TRUE(find_remedies(input, without, 1.5, Planner::kCyclic).longer_reads);
}

// The device without points is on no line.
TEST(Remedies, OnlyDevicesThatAreReadAreSpread) {
  ScheduleInput input = test::input_of(two_groups(), kFakeProtocol);
  input.devices.push_back(input.devices.front());
  const auto single = [](const ScheduleInput& other) { return other.points.size() <= 5; };
  EXPECT_EQ(find_remedies(input, single, 1.5, Planner::kCyclic).buses, 2u);
  std::erase_if(input.points, [](const Point& point) { return point.device != 0; });
  EXPECT_FALSE(find_remedies(input, single, 1.5, Planner::kCyclic).buses);
}

TEST(Prediction, NothingToReadIsFeasible) {
  const Prediction prediction = predict(ScheduleInput{});
  EXPECT_TRUE(prediction.feasible);
  EXPECT_EQ(prediction.load, 0.0);
}

using Changes = std::vector<PlannedTime>;

constexpr std::array<std::size_t, 2> kAreas{2, 1};  // two devices

TEST(PlannedTimes, MicrosecondsMakeNoOtherPlan) {
  EXPECT_EQ(PlannedTimes::rounded(-1ms), 0ms);
  EXPECT_EQ(PlannedTimes::rounded(0ms), 0ms);
  for (const Duration time : {Duration{1990us}, Duration{2ms}, Duration{2005us}})
    EXPECT_EQ(PlannedTimes::rounded(time), 2ms);
  EXPECT_EQ(PlannedTimes::rounded(2100us), 2250us) << "rather too long than too short";
  EXPECT_EQ(PlannedTimes::rounded(20ms), 20ms);
  EXPECT_EQ(PlannedTimes::rounded(100ms), 100ms);
}

TEST(PlannedTimes, WhatHasNotRespondedIsTakenToBeLikeWhatHas) {
  PlannedTimes times(kAreas, 5ms);
  EXPECT_EQ(times.responded(0, 1, 2005us), (Changes{{0, 1, 2ms}, {0, 0, 2ms}, {1, 0, 2ms}}));
  EXPECT_EQ(times.responded(1, 0, 9ms), (Changes{{1, 0, 9ms}})) << "the others are known";
}

TEST(PlannedTimes, SmallChangesAreNotReported) {
  PlannedTimes times(kAreas, 5ms);
  for (int i = 0; i < 200; ++i)
    EXPECT_EQ(times.responded(0, 0, i % 2 == 0 ? 4700us : 5200us), Changes{});
}

BusSpec bus_of(std::uint32_t registers, Duration refresh, std::uint32_t baud) {
  BusSpec bus;
  bus.name = "one";
  SerialPortSpec port;
  port.line = {baud, 8, Parity::kEven, 1};
  bus.port = port;
  DeviceSpec device;
  device.name = "plc";
  device.protocol = "modbus-rtu";
  device.link.address = 1;
  for (std::uint32_t i = 0; i < registers; ++i) {
    ChannelSpec channel;
    channel.name = "r" + std::to_string(i);
    channel.range = {2, 150 * i, 1};
    channel.refresh = refresh;
    device.channels.push_back(channel);
  }
  bus.devices.push_back(device);
  return bus;
}

TEST(LoadCheck, ABusWithSpaceHasNone) {
  EXPECT_FALSE(overload_of(bus_of(10, 1s, 19200), 5ms));
  EXPECT_FALSE(hopeless_load_of(bus_of(10, 1s, 19200)));
}

TEST(LoadCheck, LoadAndStretchAreThoseOfThePlan) {
  // 19 ms each: 15 characters of 11 bits, two silences and 5 ms; 80 reads need 1.5 s.
  const auto overload = overload_of(bus_of(80, 1s, 19200), 5ms);
  ASSERT_TRUE(overload);
  EXPECT_NEAR(overload->load, 1.5, 0.2);
  EXPECT_NEAR(overload->stretch, overload->load, 0.2);
  EXPECT_EQ(overload->baud, 38400u);
  EXPECT_FALSE(overload_of(bus_of(80, 1s, 38400), 5ms));
}

TEST(LoadCheck, ARefreshShorterThanItsOwnReadCountsAsItIsAskedFor) {
  const auto overload = overload_of(bus_of(1, 1ms, 19200), 5ms);
  ASSERT_TRUE(overload);
  EXPECT_GT(overload->load, 15);
  EXPECT_GT(overload->stretch, 15);
  EXPECT_FALSE(overload->baud);
}

// A read of 50 registers needs 138 ms of 9600 baud, and the other refresh is 100 ms.
TEST(LoadCheck, ALongReadThatDelaysAShortRefreshIsReportedAtAnyLoad) {
  BusSpec bus = bus_of(2, 100ms, 9600);
  ChannelSpec& name = bus.devices[0].channels[1];
  name.range.count = 50;
  name.refresh = 10s;
  const auto overload = overload_of(bus, 5ms);
  ASSERT_TRUE(overload);
  EXPECT_LT(overload->load, 0.5);
  EXPECT_NEAR(overload->stretch, 1.65, 0.1);
  EXPECT_EQ(overload->baud, 19200u);
  EXPECT_THAT(to_text(*overload), AllOf(HasSubstr("do not fit together on the wire"),
                                        Not(HasSubstr("more is wanted"))));
  name.refresh = 100ms;
  name.range.count = 1;
  EXPECT_FALSE(overload_of(bus, 5ms));
}

// The plan rounds the refreshes down to multiples of the shortest.
TEST(LoadCheck, RefreshesThatFitByTheirLoadAndNotByThePlanAreReported) {
  BusSpec bus = bus_of(4, 100ms, 9600);
  for (const std::size_t slower : {1u, 3u}) bus.devices[0].channels[slower].refresh = 250ms;
  const auto overload = overload_of(bus, 5ms);
  ASSERT_TRUE(overload);
  EXPECT_LE(overload->load, 1);
  EXPECT_GT(overload->stretch, 1.02);
}

TEST(LoadCheck, WhatIsReadOnlyOnDemandOrOnInterestCostsNothing) {
  BusSpec bus = bus_of(100, 1s, 19200);
  for (ChannelSpec& channel : bus.devices[0].channels) channel.on_interest = true;
  bus.devices[0].channels[0].on_interest = false;
  bus.devices[0].channels[1].mode = Mode::kOnDemand;
  EXPECT_FALSE(overload_of(bus, 5ms));
}

TEST(LoadCheck, HopelessIsAHundredTimesTheWireAtTheLeast) {
  EXPECT_FALSE(hopeless_load_of(bus_of(400, 100ms, 19200)));
  const auto load = hopeless_load_of(bus_of(400, 10ms, 19200));
  ASSERT_TRUE(load);
  EXPECT_NEAR(*load, 500, 100);
}

TEST(LoadCheck, TextStatesTheAmountAndTheFix) {
  EXPECT_THAT(to_text(Overload{2.5, 2.625, 57600}),
              testing::AllOf(HasSubstr("2.50 times"), HasSubstr("2.62 times as long"),
                             HasSubstr("at 57600 baud or more"), HasSubstr("'fieldcast plan'")));
  EXPECT_THAT(to_text(Overload{30, 31, std::nullopt}),
              testing::AllOf(HasSubstr("30 times"), Not(HasSubstr("baud"))));
}

class Advice : public testing::Test {
 protected:
  Advice() { plan_.prediction.feasible = false; }
  Remedies& remedies() { return plan_.prediction.remedies; }
  BusSpec bus_ = bus_of(2, 1s, 19200);
  BusPlan plan_ = make_plan(bus_, 5ms);
};

TEST_F(Advice, WithoutARemedyItIsToReadLess) {
  const auto ways = advice(plan_);
  ASSERT_EQ(ways.size(), 1u);
  EXPECT_TRUE(ways[0].starts_with("read fewer channels of each device")) << ways[0];
}

TEST_F(Advice, AConnectionWithoutALineHasNoBaud) {
  remedies().baud = 38400;
  remedies().no_pause = true;
  EXPECT_EQ(advice(plan_).size(), 2u);
  bus_.port = TcpPortSpec{.host = "127.0.0.1", .port = 502};
  const auto ways = advice(plan_);
  ASSERT_EQ(ways.size(), 1u);
  EXPECT_TRUE(ways[0].starts_with("take away the pause")) << ways[0];
}

TEST_F(Advice, ChannelsThatAreNotReadByThemselvesAreNotNamed) {
  bus_.devices[0].channels.own()[0].mode = Mode::kOnDemand;
  plan_ = make_plan(bus_, 5ms);
  plan_.prediction.feasible = false;
  remedies().slower = {{1s, 2s, {*plan_.point_of[1]}}};
  EXPECT_EQ(advice(plan_), std::vector<std::string>{"refresh plc/r1 every 2s instead of 1s"});
}

TEST(ShareOfPossible, IsUnknownWithoutABound) {
  const BusSpec bus = bus_of(2, 1s, 19200);
  BusPlan plan = make_plan(bus, 5ms);
  EXPECT_TRUE(share_of_possible(plan));
  plan.bound->load = 0;
  EXPECT_FALSE(share_of_possible(plan));
  plan.bound.reset();
  EXPECT_FALSE(share_of_possible(plan));
}

// Ten reads need 1.01 times the wire with the standard silence, and less with a learned one.
TEST(LeastLoad, IsThatOfTheShortestSilenceThatTheBusMayLearn) {
  BusSpec bus = bus_of(1, 40ms, 115200);
  bus.devices.assign(10, bus.devices[0]);
  const double standard = make_plan(bus, 1ms).bound->load;
  EXPECT_GT(standard, 1);
  bus.silence = LearnedSilence{};
  EXPECT_NEAR(make_plan(bus, 1ms).bound->load, standard - 10 * 1.45 / 40, 0.001);
  bus.silence = LearnedSilence{1ms};
  EXPECT_NEAR(make_plan(bus, 1ms).bound->load, standard - 10 * 0.75 / 40, 0.001);
  bus.silence = LearnedSilence{5ms};
  EXPECT_EQ(make_plan(bus, 1ms).bound->load, standard);
}

TEST(SilenceFor, AConnectionRestsOnlyIfItIsConfigured) {
  BusSpec bus = bus_of(2, 1s, 19200);
  bus.port = TcpPortSpec{.host = "127.0.0.1", .port = 502};
  EXPECT_EQ(silence_for(bus), Duration::zero());
  bus.silence = Duration{10ms};
  EXPECT_EQ(silence_for(bus), 10ms);
}

// Two channels of the same item: the point is read as the more urgent one asks for.
TEST(AskFor, AnIntensiveChannelMakesItsPointIntensive) {
  BusSpec bus = bus_of(2, 1s, 19200);
  auto& channels = bus.devices[0].channels.own();
  channels[1].range = channels[0].range;
  channels[1].mode = Mode::kIntensive;
  const PointMap map = map_points(bus);
  ASSERT_EQ(map.points.size(), 1u);
  EXPECT_EQ(map.points[0].mode, Mode::kIntensive);
}

}  // namespace
}  // namespace fieldcast
