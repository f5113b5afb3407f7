#include "tools/cli/view/status_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fieldcast::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

StatusModel plant() {
  StatusModel model;
  StationBusStatus bus{
      "line-7", "press-shop", {}, {{"CHECKSUM", 3}, {"NO_ANSWER", 12}}, UtcTime{1'000'000'000}};
  bus.report.state = BusState::kRunning;
  bus.report.utilisation = 0.731;
  bus.report.exchanges = 400;
  model.buses[bus.bus] = bus;
  StationDeviceStatus device{"press-shop", "press-1", {}, {}, UtcTime{1'000'000'000}};
  device.report.state = DeviceState::kOnline;
  device.report.answer_time = 2150us;
  device.report.refused = {"holding:107"};
  device.report.refused_gaps = {"holding:110..115"};
  device.report.areas = {{"holding", 2100us, 40us, 60, 64}};
  model.devices[{device.bus, device.device}] = device;
  return model;
}

TEST(StatusView, ShowsUseOfTheWireAndCountersByCause) {
  const auto lines = status_lines(plant(), UtcTime{1'500'000'000}, {});
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_THAT(lines[1],
              testing::AllOf(HasSubstr("press-shop"), HasSubstr("running"), HasSubstr("73.1 %"),
                             HasSubstr("0.50 s"), HasSubstr("CHECKSUM 3, NO_ANSWER 12")));
  EXPECT_THAT(lines[4], testing::AllOf(HasSubstr("press-shop/press-1"), HasSubstr("2.15 ms"),
                                       HasSubstr("holding:107"), HasSubstr("holding:110..115"),
                                       HasSubstr("holding 2.10 ms, blocks to 60, at most 64")));
}

TEST(StatusView, JsonHasTheFieldsOfTheIdl) {
  const auto model = plant();
  const auto bus = status_json(model.buses.at("press-shop"));
  EXPECT_EQ(bus["bus"], "press-shop");
  EXPECT_EQ(bus["causes"]["NO_ANSWER"], 12);
  EXPECT_EQ(bus["utilisation"], 0.731);
  const auto device = status_json(model.devices.begin()->second);
  EXPECT_EQ(device["answer_time"], 2'150'000);
  EXPECT_EQ(to_line(device["refused"]), R"(["holding:107"])");
  EXPECT_EQ(device["areas"][0]["longest_block"], 64);
}

TEST(StatusView, AClosedBusSaysWhy) {
  StatusModel model = plant();
  BusReport& report = model.buses.at("press-shop").report;
  report.state = BusState::kClosed;
  report.closed_because = Cause::kPortMissing;
  EXPECT_THAT(status_lines(model, UtcTime{1'500'000'000}, {})[1],
              HasSubstr("closed: no such device file"));
  EXPECT_EQ(status_json(model.buses.at("press-shop"))["closed_because"], "PORT_MISSING");
  report.state = BusState::kRunning;
  report.closed_because = Cause::kNone;
  EXPECT_FALSE(status_json(model.buses.at("press-shop")).contains("closed_because"));
}

TEST(StatusView, BytesThatAreNoAnswersComeWithWhatToTry) {
  StatusModel model = plant();
  StationDeviceStatus& device = model.devices.begin()->second;
  device.report.state = DeviceState::kDegraded;
  device.causes = {{"CHECKSUM", 41}};
  EXPECT_THAT(status_lines(model, UtcTime{1'500'000'000}, {}).back(),
              testing::AllOf(HasSubstr("press-shop/press-1: bytes come that are no answers"),
                             HasSubstr("CHECKSUM 41"), HasSubstr("baud, parity")));
  device.report.state = DeviceState::kOnline;
  EXPECT_THAT(status_lines(model, UtcTime{1'500'000'000}, {}).back(),
              testing::Not(HasSubstr("no answers")))
      << "now and then noise, which costs nothing";
}

}  // namespace
}  // namespace fieldcast::cli
