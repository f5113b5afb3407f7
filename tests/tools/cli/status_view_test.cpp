#include "tools/cli/view/status/status_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/cli/parsed_json.hpp"
#include "tools/cli/view/status/status_words.hpp"

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
  device.report.response_time = 2150us;
  device.report.refused = {"holding:107"};
  device.report.refused_gaps = {"holding:110..115"};
  device.report.areas = {{"holding", 2100us, 40us, 60, 64}};
  model.devices[{device.bus, device.device}] = device;
  return model;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const auto& line : lines) text += line + '\n';
  return text;
}

TEST(StatusView, EachNumberHasItsNameAndItsUnit) {
  EXPECT_EQ(joined(status_lines(plant(), UtcTime{1'500'000'000}, {})),
            "bus press-shop  bridge line-7, reported 0.50 s ago\n"
            "  state     running\n"
            "  wire      busy 73.1 % of the last second; planned 0.0 %, reading 0.0 %\n"
            "  so far    400 exchanges, 0 samples, 0 commands, port opened again 0 times\n"
            "  missed    refreshes: none\n"
            "  failures  exchanges: CHECKSUM 3, NO_ANSWER 12\n"
            "  bus/device          state   responds in  timeout  exchanges  failed  missed\n"
            "  press-shop/press-1  online      2.15 ms        -          0       0       0\n"
            "press-shop/press-1\n"
            "  area      holding: responds in 2.10 ms, blocks to 60 items so far; it accepts\n"
            "            64 at most\n"
            "  refused   addresses, which are left out of blocks: holding:107\n"
            "  gaps      unused addresses between channels that it refuses to read, so that\n"
            "            no block runs across them: holding:110..115\n");
}

TEST(StatusView, AnUnknownDeviceSaysWhatIsKnownOfIt) {
  StatusModel model = plant();
  StationBusStatus& bus = model.buses.at("press-shop");
  StationDeviceStatus device = model.devices.begin()->second;
  device.report.state = DeviceState::kUnknown;
  EXPECT_THAT(device_words(device, &bus), HasSubstr("it was not asked yet"));
  device.report.exchanges = 10;
  EXPECT_EQ(device_words(device, &bus), "unknown: it has not responded yet");
  bus.report.state = BusState::kClosed;
  EXPECT_EQ(device_words(device, &bus), "unknown: the port of its bus is closed");
}

StationBridge bridge_of(const std::string& name, bool serving, const std::string& group = "") {
  StationBridge bridge;
  bridge.bridge = name;
  bridge.host = "host-of-" + name;
  bridge.standby_group = group;
  bridge.buses = {{"press-shop", {}, serving}};
  return bridge;
}

TEST(StatusView, BridgesThatClaimTheSameBusAreNamed) {
  StatusModel model = plant();
  const StationBusStatus& bus = model.buses.at("press-shop");
  const auto put = [&](const StationBridge& bridge) { model.bridges[bridge.bridge] = bridge; };
  put(bridge_of("line-7", true));
  EXPECT_TRUE(claim_facts(model, bus).empty());
  put(bridge_of("line-8", true));
  put(bridge_of("line-9", false));
  EXPECT_THAT(
      joined(status_lines(model, UtcTime{1'500'000'000}, {})),
      HasSubstr(
          "  claims    contested: bridge line-8 on host host-of-line-8 also claims to serve\n"));
  const auto facts = claim_facts(model, bus);
  ASSERT_EQ(facts.size(), 2U);
  EXPECT_EQ(facts[0].text,
            "contested: bridge line-8 on host host-of-line-8 also claims to serve bus press-shop, "
            "whose name "
            "must be unique in the DDS domain; stop or rename one of them");
  EXPECT_EQ(
      facts[1].text,
      "refused: bridge line-9 on host host-of-line-9 has a bus of this name and does not serve it, "
      "because bridge line-7 does; rename one of the buses");
  Json written = status_json(bus);
  add_claims(written, model, bus);
  const auto line = parsed(written);
  EXPECT_EQ(line["contested_by"].dump(), R"([{"bridge":"line-8","host":"host-of-line-8"}])");
  EXPECT_EQ(line["waiting_bridges"].dump(), R"([{"bridge":"line-9","host":"host-of-line-9"}])");
}

TEST(StatusView, MembersOfAStandbyGroupDoNotContestItsBuses) {
  StatusModel model = plant();
  for (const char* name : {"line-7", "line-8"})
    model.bridges[name] = bridge_of(name, name == std::string("line-7"), "pair");
  EXPECT_TRUE(claim_facts(model, model.buses.at("press-shop")).empty());
  Json line = Json::object();
  add_claims(line, model, model.buses.at("press-shop"));
  EXPECT_EQ(line.text(), "{}");
}

TEST(StatusView, ManyClaimantsAreCounted) {
  StatusModel model = plant();
  for (int i = 0; i < 50; ++i) {
    const auto bridge = bridge_of("forger-" + std::to_string(100 + i), true);
    model.bridges[bridge.bridge] = bridge;
  }
  EXPECT_THAT(claim_facts(model, model.buses.at("press-shop")).at(0).text,
              HasSubstr("bridge forger-102 on host host-of-forger-102 and 47 more also claims"));
}

TEST(StatusView, EightyColumnsAreEnough) {
  StatusModel model = plant();
  for (int i = 0; i < 40; ++i)
    model.devices.begin()->second.report.refused.push_back("holding:" + std::to_string(1000 + i));
  model.devices.begin()->second.report.state = DeviceState::kOffline;
  model.devices.begin()->second.causes = {{"NO_ANSWER", 41}, {"CHECKSUM", 2}, {"TRUNCATED", 1}};
  for (const auto& line : status_lines(model, UtcTime{1'500'000'000}, {}))
    EXPECT_LE(display_width(line), 80u) << line;
  for (const auto& line : status_lines(model, UtcTime{1'500'000'000}, {20, 0, false}))
    EXPECT_LE(display_width(line), 80u) << line;
}

TEST(StatusView, ADeviceThatIsOfflineSaysWhy) {
  StatusModel model = plant();
  StationDeviceStatus& device = model.devices.begin()->second;
  device.report.state = DeviceState::kOffline;
  device.causes = {{"NO_ANSWER", 41}, {"CHECKSUM", 2}};
  EXPECT_THAT(
      joined(status_lines(model, UtcTime{1'500'000'000}, {200, 0, false})),
      HasSubstr("offline: no response 41 times, checksum error 2 times; look at its power, its "
                "cable, its address and the baud rate; it is polled less and less often"));
  model.buses.at("press-shop").report.state = BusState::kClosed;
  model.buses.at("press-shop").report.closed_because = Cause::kPortInUse;
  EXPECT_THAT(joined(status_lines(model, UtcTime{1'500'000'000}, {})),
              HasSubstr("offline: the port of its bus is closed (in use by another program)"));
}

TEST(StatusView, JsonHasTheFieldsOfTheIdl) {
  const auto model = plant();
  const auto bus = parsed(status_json(model.buses.at("press-shop")));
  EXPECT_EQ(bus["bus"], "press-shop");
  EXPECT_EQ(bus["causes"]["NO_ANSWER"], 12);
  EXPECT_EQ(bus["utilisation"], 0.731);
  const auto device = parsed(status_json(model.devices.begin()->second));
  EXPECT_EQ(device["answer_time"], 2'150'000);
  EXPECT_EQ(device["refused"].dump(), R"(["holding:107"])");
  EXPECT_EQ(device["areas"][0]["longest_block"], 64);
}

TEST(StatusView, AClosedBusSaysWhy) {
  StatusModel model = plant();
  BusReport& report = model.buses.at("press-shop").report;
  report.state = BusState::kClosed;
  report.closed_because = Cause::kPortMissing;
  EXPECT_THAT(joined(status_lines(model, UtcTime{1'500'000'000}, {})),
              HasSubstr("closed: no such device file; look whether the adapter is plugged in"));
  EXPECT_EQ(parsed(status_json(model.buses.at("press-shop")))["closed_because"], "PORT_MISSING");
  report.state = BusState::kRunning;
  report.closed_because = Cause::kNone;
  EXPECT_FALSE(parsed(status_json(model.buses.at("press-shop"))).contains("closed_because"));
}

TEST(StatusView, BytesThatAreNoResponsesComeWithWhatToTry) {
  StatusModel model = plant();
  StationDeviceStatus& device = model.devices.begin()->second;
  device.report.state = DeviceState::kDegraded;
  device.causes = {{"CHECKSUM", 41}};
  EXPECT_THAT(joined(status_lines(model, UtcTime{1'500'000'000}, {200, 0, false})),
              testing::AllOf(HasSubstr("press-shop/press-1"),
                             HasSubstr("bytes arrive that are not responses"),
                             HasSubstr("CHECKSUM 41"), HasSubstr("baud rate, parity")));
  device.report.state = DeviceState::kOnline;
  EXPECT_THAT(joined(status_lines(model, UtcTime{1'500'000'000}, {200, 0, false})),
              testing::Not(HasSubstr("are no responses")))
      << "now and then noise, which costs nothing";
}

}  // namespace
}  // namespace fieldcast::cli
