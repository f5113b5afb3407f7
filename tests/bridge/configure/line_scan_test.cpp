#include "bridge/configure/line_scan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/bus/rtu_bus.hpp"

namespace fieldcast::configure {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<unsigned> addresses(const ScanPart& part) {
  std::vector<unsigned> all;
  for (const DeviceSpec& device : part.devices) all.push_back(device.link.address);
  return all;
}

ProbedDevice probed(std::initializer_list<Cause> causes) {
  ProbedDevice device{"address", {}};
  for (const Cause cause : causes) {
    ProbedChannel& channel = device.channels.emplace_back();
    channel.name = device.channels.size() == 1 ? "input-register:0" : "holding:0";
    channel.cause = cause;
    channel.took = 12ms;
    if (cause == Cause::kNone)
      channel.value = Value{std::uint64_t{17}};
    else
      channel.reason = to_text(cause);
    channel.responded = cause == Cause::kNone || cause == Cause::kDeviceError;
  }
  return device;
}

json shown(const ScanPart& part, const std::vector<ProbedDevice>& devices) {
  return json::parse(scan_json(part, devices).text());
}

TEST(LineScan, RequestsTheAddressesThatNoDeviceOfTheBusHas) {
  BusSpec bus = test::rtu_bus(3);
  bus.devices[0].timeout = 70ms;
  const auto part = scan_part(bus, "modbus-rtu", 1, 7);
  ASSERT_TRUE(part);
  EXPECT_THAT(addresses(*part), ElementsAre(4, 5, 6, 7));
  EXPECT_FALSE(part->next);
  const DeviceSpec& device = part->devices.front();
  EXPECT_EQ(device.timeout, 70ms);
  EXPECT_EQ(part->questions, 2u) << "a device may ignore an area that it does not have";
  ASSERT_EQ(device.channels.size(), 3u);
  EXPECT_NE(device.channels[0].range.area, device.channels[1].range.area);
  EXPECT_EQ(device.channels[2].at, "id:basic");
}

// A value of a type that is longer than its items would end the bridge.
TEST(LineScan, EachValueFitsItsItems) {
  for (const char* protocol : {"modbus-rtu", "mitsubishi-fx", "s7-ppi", "omron-hostlink"}) {
    BusSpec bus = test::rtu_bus(1);
    bus.devices[0].protocol = protocol;
    const auto part = scan_part(bus, protocol, 2, 2);
    ASSERT_TRUE(part) << part.error();
    const DeviceSpec& device = part->devices.at(0);
    const auto made = make_protocol(device, {});
    for (const ChannelSpec& channel : device.channels)
      EXPECT_LE(item_count(channel.encoding, (*made)->areas()[channel.range.area].item_bits),
                channel.range.count)
          << protocol << ' ' << channel.at;
  }
}

TEST(LineScan, ShowsTheIdentity) {
  const auto part = scan_part(test::rtu_bus(1), "modbus-rtu", 2, 3);
  ProbedDevice named = probed({Cause::kNone});
  ProbedChannel& identity = named.channels.emplace_back();
  identity.name = "id:basic";
  identity.value = Value{std::string("Siemens AG, PAC3200, 2.1\x1b")};
  const json found = shown(*part, {named, probed({Cause::kNone, Cause::kExpired})});
  EXPECT_EQ(found["found"][0]["identity"], "Siemens AG, PAC3200, 2.1\\x1B");
  EXPECT_EQ(found["found"][1]["identity"], "");
  EXPECT_TRUE(found["next"].is_null()) << "the device was found, although no time was left";
}

TEST(LineScan, GoesOnAfterSixteenAddresses) {
  const BusSpec bus = test::rtu_bus(3);
  const auto part = scan_part(bus, "modbus-rtu", 1, 247);
  EXPECT_EQ(addresses(*part).size(), DeviceProbe::kMostDevices);
  EXPECT_EQ(part->next, 20);
  EXPECT_TRUE(scan_part(bus, "modbus-rtu", 1, 3)->devices.empty());
}

TEST(LineScan, RefusesWhatTheBusDoesNotHave) {
  const BusSpec bus = test::rtu_bus(1);
  EXPECT_THAT(scan_part(bus, "dtc", 1, 2).error(), HasSubstr("'dtc'"));
  for (const auto& [first, last] : {std::pair(0u, 2u), {1u, 248u}, {5u, 4u}})
    EXPECT_THAT(scan_part(bus, "modbus-rtu", first, last).error(), HasSubstr("1 to 247"));
}

TEST(LineScan, ShowsWhateverIsNotSilent) {
  const auto part = scan_part(test::rtu_bus(1), "modbus-rtu", 1, 5);
  const json found =
      shown(*part, {probed({Cause::kNoResponse, Cause::kNoResponse}), probed({Cause::kNone}),
                    probed({Cause::kNoResponse, Cause::kDeviceError}), probed({Cause::kChecksum})});
  EXPECT_EQ(found["error"], "");
  EXPECT_TRUE(found["next"].is_null());
  ASSERT_EQ(found["found"].size(), 3u);
  EXPECT_EQ(found["found"][0], (json{{"address", "3"},
                                     {"protocol", "modbus-rtu"},
                                     {"response", "input-register:0 = 17"},
                                     {"responded", true},
                                     {"took_ms", 12},
                                     {"identity", ""}}));
  EXPECT_EQ(found["found"][1]["address"], "4");
  EXPECT_EQ(found["found"][2]["responded"], false);
}

TEST(LineScan, AnAddressThatWasNotRequestedIsTheNextOne) {
  const auto part = scan_part(test::rtu_bus(1), "modbus-rtu", 1, 5);
  const json later = shown(*part, {probed({Cause::kNone}), probed({Cause::kExpired})});
  EXPECT_EQ(later["next"], 3);
  EXPECT_EQ(later["error"], "") << "some free time was found";
  EXPECT_EQ(later["found"].size(), 1u);
  const json never = shown(*part, {probed({Cause::kExpired})});
  EXPECT_EQ(never["next"], 2);
  EXPECT_THAT(std::string(never["error"]), HasSubstr("shorter timeout"));
}

}  // namespace
}  // namespace fieldcast::configure
