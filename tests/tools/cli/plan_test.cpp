#include "tools/cli/command/plan.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/protocol/families/registry.hpp"
#include "tests/tools/cli/parsed_json.hpp"
#include "tools/cli/model/bus_plan.hpp"
#include "tools/cli/view/plan_view.hpp"

namespace fieldcast::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

ChannelSpec channel(std::string name, std::uint32_t first, Duration refresh) {
  ChannelSpec channel;
  channel.name = std::move(name);
  channel.at = "holding:" + std::to_string(first);
  channel.refresh = refresh;
  Range range;
  const auto areas = find_protocol("modbus-rtu")->make({1, {}}).value()->parse_address(channel.at);
  range.area = areas->area;
  range.first = first;
  channel.range = range;
  return channel;
}

BusSpec line(std::vector<ChannelSpec> channels) {
  BusSpec bus;
  bus.name = "line";
  bus.port = SerialPortSpec{"/dev/ttyUSB0", {9600, 8, Parity::kEven, 1}};
  DeviceSpec device;
  device.name = "meter";
  device.protocol = "modbus-rtu";
  device.channels = std::move(channels);
  bus.devices = {device};
  return bus;
}

TEST(BusPlan, ChannelsOnTheSameItemsShareAPointOfTheShortestRefresh) {
  const auto bus = line({channel("a", 5, 2s), channel("b", 5, 1s), channel("c", 6, 1s)});
  const auto plan = make_plan(bus, 5ms);
  EXPECT_EQ(plan.point_of[0], plan.point_of[1]);
  EXPECT_NE(plan.point_of[0], plan.point_of[2]);
  EXPECT_EQ(plan.input.points[*plan.point_of[0]].refresh, Duration{1s});
}

TEST(BusPlan, WhatIsReadOnlyOnDemandCostsNothing) {
  auto on_demand = channel("a", 5, 1s);
  on_demand.mode = Mode::kOnDemand;
  auto write_only = channel("b", 6, 1s);
  write_only.access = Access::kWriteOnly;
  auto on_interest = channel("c", 7, 1s);
  on_interest.on_interest = true;
  const auto bus = line({on_demand, write_only, on_interest});
  const auto plan = make_plan(bus, 5ms);
  for (const Point& point : plan.input.points) EXPECT_EQ(point.mode, Mode::kOnDemand);
  EXPECT_EQ(plan.prediction.load, 0);
  EXPECT_TRUE(plan.prediction.feasible);
  EXPECT_THAT(
      plan_lines(plan, {}),
      testing::Contains("3 channels are read only when somebody asks, and cost nothing here"));
}

TEST(PlanView, ShowsTheOrderOfWideValuesAndTexts) {
  auto wide = channel("a", 0, 1s), text = channel("b", 10, 1s), narrow = channel("c", 20, 1s);
  wide.encoding = {.type = ValueType::kInt32, .word_order = WordOrder::kLittleEndian};
  wide.range.count = 2;
  text.encoding = {
      .type = ValueType::kString, .string_bytes = 4, .byte_order = ByteOrder::kLittleEndian};
  text.range.count = 2;
  const auto bus = line({wide, text, narrow});
  const auto plan = make_plan(bus, 5ms);
  EXPECT_THAT(plan_lines(plan, {}),
              testing::AllOf(testing::Contains(HasSubstr("int32, low word first")),
                             testing::Contains(HasSubstr("string(4), low byte first"))));
  const auto json = parsed(plan_json(plan));
  for (const auto& row : json["channels"]) {
    EXPECT_EQ(row["word_order"], row["channel"] == "a" ? "little-endian" : "big-endian");
    EXPECT_EQ(row["byte_order"], row["channel"] == "b" ? "little-endian" : "big-endian");
    EXPECT_FALSE(row["type"].get<std::string>().empty());
  }
}

TEST(PlanView, NamesABlockByTheAddressesOfTheConfiguration) {
  const auto bus = line({channel("b", 12, 1s), channel("a", 10, 1s), channel("far", 4000, 1s)});
  EXPECT_THAT(
      plan_lines(make_plan(bus, 5ms), {}),
      testing::IsSupersetOf({testing::StartsWith("holding:10 .. holding:12  meter        2"),
                             testing::StartsWith("holding:4000              meter        1")}));
}

TEST(PlanView, FeasiblePlanNeedsNoAdvice) {
  const auto bus = line({channel("a", 0, 1s), channel("b", 4000, 1s)});
  const auto plan = make_plan(bus, 5ms);
  ASSERT_TRUE(plan.prediction.feasible);
  EXPECT_TRUE(advice(plan).empty());
  const auto json = parsed(plan_json(plan));
  EXPECT_EQ(json["feasible"], true);
  EXPECT_EQ(json["channels"].size(), 2u);
  EXPECT_LE(json["channels"][0]["worst_gap"], json["channels"][0]["refresh"]);
  EXPECT_EQ(json["answer_time"], 5'000'000);
  EXPECT_THAT(plan_lines(plan, {}).front(), HasSubstr("line  /dev/ttyUSB0 9600 8E1: feasible"));
  // Two registers, each with a request: 22 characters, 5 ms and the silence, 11 bits at 9600 baud.
  EXPECT_NEAR(json["least_load"].get<double>(), 2 * (15 * 11 / 9600.0 + 0.005 + 0.004), 0.005);
  EXPECT_GT(json["share_of_possible"].get<double>(), 0.7);
  EXPECT_LE(json["share_of_possible"].get<double>(), 1);
  EXPECT_THAT(plan_lines(plan, {})[1], HasSubstr(" % of what any master can reach"));
}

TEST(PlanView, JsonHoldsThePlanThatTheSchedulerFollows) {
  const auto bus =
      line({channel("fast", 0, 200ms), channel("slow", 1, 1s), channel("far", 4000, 1s)});
  const auto plan = make_plan(bus, 5ms);
  const ReadPlan& followed = plan.prediction.plan;
  const auto json = parsed(plan_json(plan))["plan"];
  EXPECT_EQ(json["load"], followed.planned_load());
  EXPECT_EQ(json["slot"], followed.slot().count());
  EXPECT_EQ(json["hyperperiod"], followed.hyperperiod().count());
  ASSERT_EQ(json["groups"].size(), 2u);
  const auto near = json["groups"][0];
  EXPECT_EQ(near["device"], "meter");
  EXPECT_EQ(near["period"], followed.groups[0].period.count());
  ASSERT_EQ(near["points"].size(), 2u);
  EXPECT_EQ(near["points"][1]["channels"], (std::vector<std::string>{"slow"}));
  EXPECT_EQ(near["points"][1]["first"], 1);
  EXPECT_GT(near["points"][1]["period"], near["points"][0]["period"]);
  EXPECT_LE(near["points"][1]["worst_gap"], 1'000'000'000);
}

TEST(PlanView, PlanWithoutATimetableHasNoSlotsAndNoPeriods) {
  auto bus = line({channel("a", 0, 1s)});
  bus.planner = Planner::kDynamicBlocks;
  const auto json = parsed(plan_json(make_plan(bus, 5ms)))["plan"];
  EXPECT_TRUE(json["slot"].is_null());
  EXPECT_TRUE(json["groups"][0]["points"][0]["worst_gap"].is_null());
  EXPECT_GT(json["groups"][0]["load"], 0);
}

TEST(PlanView, InfeasiblePlanSaysWhatWouldHelp) {
  const auto bus = line({channel("a", 0, 20ms),
                         channel("b", 4000, 20ms)});  // a single read takes longer at 9600 baud
  const auto plan = make_plan(bus, 5ms);
  ASSERT_FALSE(plan.prediction.feasible);
  EXPECT_FALSE(advice(plan).empty());
  EXPECT_THAT(plan_lines(plan, {}).front(), HasSubstr("NOT FEASIBLE"));
  EXPECT_THAT(plan_lines(plan, {}), testing::Contains("any of these would make it feasible:"));
  EXPECT_THAT(plan_lines(plan, {})[1],
              HasSubstr("proven impossible: any master needs at least 2."));
  EXPECT_TRUE(parsed(plan_json(plan))["share_of_possible"].is_null());
}

TEST(PlanView, ChannelsToSlowDownAreOneWayAndLoadIsReportedInWires) {
  // 16 characters and 5 ms: 25 ms each at 9600 baud, with refreshes of 10 ms and 15 ms.
  const auto bus =
      line({channel("a", 0, 10ms), channel("b", 4000, 10ms), channel("c", 8000, 15ms)});
  const auto plan = make_plan(bus, 5ms);
  EXPECT_NEAR(plan.prediction.planned_load, 7, 2);
  EXPECT_THAT(plan_lines(plan, {}).front(), HasSubstr("times the wire is needed"));
  const auto ways = advice(plan);
  EXPECT_THAT(ways, testing::Contains(testing::AllOf(HasSubstr("refresh 2 channels ("),
                                                     HasSubstr("instead of 10ms, and "),
                                                     HasSubstr("instead of 15ms"))));
  EXPECT_EQ(std::count_if(ways.begin(), ways.end(),
                          [](const auto& way) { return way.starts_with("refresh"); }),
            1);
}

TEST(PlanView, LimitsOfADeviceThatMakeItTooSlowAreNamed) {
  std::vector<ChannelSpec> channels;
  for (std::uint32_t i = 0; i < 40; ++i)
    channels.push_back(channel("c" + std::to_string(i), i, 500ms));
  auto bus = line(channels);
  EXPECT_TRUE(make_plan(bus, 5ms).prediction.feasible);
  bus.devices[0].max_block = 1;
  EXPECT_THAT(advice(make_plan(bus, 5ms)), testing::Contains(HasSubstr("take away max-block")));
  bus.devices[0].max_block = 0;
  bus.devices[0].pause = 1s;
  EXPECT_THAT(advice(make_plan(bus, 5ms)), testing::Contains(HasSubstr("take away the pause")));
}

TEST(PlanView, ANetworkIsNotAdvisedABaudRate) {
  auto bus = line({channel("a", 0, 10ms), channel("b", 4000, 10ms)});
  bus.port = TcpPortSpec{"10.0.0.7", 502, std::nullopt};
  const auto plan = make_plan(bus, 20ms);
  ASSERT_FALSE(plan.prediction.feasible);
  for (const auto& way : advice(plan)) EXPECT_THAT(way, testing::Not(HasSubstr("baud")));
}

TEST(PlanView, TightestChannelComesFirst) {
  const auto bus =
      line({channel("slow", 0, 5s), channel("fast", 4000, 100ms), channel("other", 9000, 700ms)});
  const auto json = parsed(plan_json(make_plan(bus, 5ms)));
  ASSERT_EQ(json["channels"].size(), 3u);
  double before = 1e9;
  for (const auto& row : json["channels"]) {
    const auto tightness = row["worst_gap"].get<double>() / row["refresh"].get<double>();
    EXPECT_LE(tightness, before);
    before = tightness;
  }
}

// A signal ends the command at any time: the output has the buses that are planned.
TEST(PlanCommand, WritesEachBusWhenItIsPlanned) {
  struct Counted : std::stringbuf {
    int sync() override {
      ++flushes;
      return std::stringbuf::sync();
    }
    int flushes = 0;
  };
  const std::string file = std::filesystem::temp_directory_path() /
                           ("fieldcast-plan-" + std::to_string(::getpid()) + ".yaml");
  std::ofstream plant(file);
  plant << "bridge: b\nbuses:\n";
  for (const char* bus : {"one", "two"})
    plant << fmt::format(
        "  - name: {0}\n    port: {{ serial: /dev/{0} }}\n    protocol: modbus-rtu\n    devices:\n"
        "      - {{ name: d, address: 1, channels: [ {{ name: c, at: \"coil:3\" }} ] }}\n",
        bus);
  plant.close();
  for (const bool json : {false, true}) {
    Counted counted;
    std::ostream out(&counted);
    std::istringstream in;
    std::ostringstream err;
    EXPECT_EQ(plan({.config = file, .json = json}, {in, out, err}), ExitCode::kOk) << err.str();
    EXPECT_EQ(counted.flushes, 2) << json;
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace fieldcast::cli
