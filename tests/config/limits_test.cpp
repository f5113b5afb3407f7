#include "config/document/limits.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bridge/security/member_folder.hpp"
#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

using testing::HasSubstr;

static_assert(kMaxSecureDomain == security::kHighestDomain);

std::string channel_lines(std::size_t count) {
  std::string lines;
  for (std::size_t i = 0; i < count; ++i) {
    lines += "          - { name: c" + std::to_string(i) +
             ", at: \"holding:" + std::to_string(i % 60000) + "\", type: int16 }\n";
  }
  return lines;
}

Loaded load(const std::string& text) { return load_text(text, "plant.yaml", {}); }

TEST(Limits, AHundredThousandChannelsLoadAndOneMoreIsAFault) {
  const auto most = load(plant(channel_lines(kMaxChannels)));
  ASSERT_TRUE(most) << faults_of(most);
  EXPECT_EQ(most->buses[0].devices[0].channels.size(), kMaxChannels);

  const auto more = load(plant(channel_lines(kMaxChannels + 1)));
  EXPECT_EQ(faults_of(more), "plant.yaml:10:11: too many channels; allowed: 100000 of a bridge\n");
}

TEST(Limits, ChannelsOfTemplatesCountOnceForEachDevice) {
  std::string shared = "channels:\n";
  for (int i = 0; i < 1000; ++i)
    shared += "  - { name: c" + std::to_string(i) + ", at: \"coil:" + std::to_string(i) + "\" }\n";
  std::string text =
      "bridge: b\nbuses:\n  - name: bus\n    port: { tcp: \"h:502\" }\n    protocol: modbus-tcp\n  "
      "  devices:\n";
  for (int i = 1; i <= 101; ++i)
    text += "      - { name: d" + std::to_string(i) + ", address: " + std::to_string(i) +
            ", template: big }\n";
  const auto loaded = load_text(text, "plant.yaml", texts({{"devices/big.yaml", shared}}));
  EXPECT_EQ(faults_of(loaded),
            "plant.yaml:107:9: too many channels; allowed: 100000 of a bridge\n");
}

std::string buses(std::size_t count) {
  std::string text = "bridge: b\nbuses:\n";
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = std::to_string(i);
    text += "  - { name: b" + n + ", port: { serial: /dev/ttyS" + n +
            " }, protocol: modbus-rtu, devices: [ { name: d, address: 1, allow: [raw-read] } ] }\n";
  }
  return text;
}

TEST(Limits, TwoHundredAndFiftySixBusesLoadAndOneMoreIsAFault) {
  EXPECT_EQ(faults_of(load(buses(kMaxBuses))), "");
  EXPECT_EQ(faults_of(load(buses(kMaxBuses + 1))),
            "plant.yaml:259:5: too many buses; allowed: 256 of a bridge\n");
}

TEST(Limits, ABusHoldsAsManyDevicesAsModbusHasAddresses) {
  std::string text =
      "bridge: b\nbuses:\n  - name: bus\n    port: { tcp: \"h:502\" }\n    protocol: modbus-tcp\n  "
      "  devices:\n";
  for (unsigned i = 1; i <= kMaxDevices; ++i) {
    text += "      - { name: d" + std::to_string(i) + ", address: " + std::to_string(i) +
            ", allow: [raw-read] }\n";
  }
  EXPECT_EQ(faults_of(load(text)), "");
  EXPECT_EQ(faults_of(load(text + "      - { name: more, address: 248, allow: [raw-read] }\n")),
            "plant.yaml:254:9: too many devices; allowed: 247 of a bus\n");
}

TEST(Limits, ABridgeHoldsAsManyDevicesAsReportTheirState) {
  const auto plant_of = [](std::size_t devices) {
    std::string text = "bridge: b\nbuses:\n";
    for (std::size_t i = 0; i < devices; ++i) {
      if (i % 200 == 0)
        text += fmt::format(
            "  - name: b{0}\n    port: {{ tcp: \"h:{0}\" }}\n    protocol: modbus-tcp\n"
            "    devices:\n",
            i / 200 + 1);
      text +=
          fmt::format("      - {{ name: d{0}, address: {0}, allow: [raw-read] }}\n", i % 200 + 1);
    }
    return text;
  };
  EXPECT_EQ(faults_of(load(plant_of(kMaxBridgeDevices))), "");
  EXPECT_EQ(faults_of(load(plant_of(kMaxBridgeDevices + 1))),
            "plant.yaml:10203:5: too many devices; allowed: 10000 of a bridge\n");
}

TEST(Limits, FaultsEndWithAWordAboutTheRest) {
  std::string lines;
  for (std::size_t i = 0; i < kMaxFaults + 50; ++i)
    lines += "          - { name: c" + std::to_string(i) + ", at: nowhere, type: int16 }\n";
  const auto loaded = load(plant(lines));
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().size(), kMaxFaults + 1);
  EXPECT_THAT(loaded.error().back().what, HasSubstr("more faults"));
}

TEST(Limits, AFileBeyondItsSizeIsNotParsed) {
  EXPECT_EQ(faults_of(load(std::string(kMaxFileBytes + 1, '['))),
            "plant.yaml:1:1: the file is too large; allowed: 16 MiB\n");
}

TEST(Limits, NamedFilesShareOneBudget) {
  const std::string list =
      "name,at,type\n" + std::string(kMaxFileBytes - 100, '#') + "\na,holding:1,int16\n";
  std::map<std::string, std::string> files;
  std::string text =
      "bridge: b\nbuses:\n  - name: bus\n    port: { tcp: \"h:502\" }\n    protocol: modbus-tcp\n  "
      "  devices:\n";
  for (int i = 1; i <= 5; ++i) {
    const auto n = std::to_string(i);
    files[n + ".csv"] = list;
    text += "      - { name: d" + n + ", address: " + n + ", channels: " + n + ".csv }\n";
  }
  EXPECT_THAT(faults_of(load_text(text, "plant.yaml", texts(files))),
              testing::EndsWith("channel list '4.csv' is too large\nplant.yaml:11:43: channel list "
                                "'5.csv' is too large\n"));
}

TEST(Limits, NestingBeyondEveryParserEndsEarly) {
  for (const char open : {'[', '{'}) EXPECT_FALSE(load(std::string(200'000, open)));
  std::string dashes = "buses:\n";
  for (int i = 0; i < 100'000; ++i) dashes += "- ";
  EXPECT_THAT(faults_of(load(dashes)), HasSubstr("too deep nesting"));
}

TEST(Limits, MoreValuesThanAnyPlantNeedsAreAFault) {
  std::string values = "buses:\n  [", anchors = "bridge: ", maps = "buses:\n";
  for (std::size_t i = 0; i <= kMaxNodes; ++i) values += "1,";
  for (int i = 0; i < 1'000'000; ++i) anchors += "&a ";
  for (std::size_t i = 0; i <= kMaxCollections; ++i) maps += "- a:\n";
  EXPECT_THAT(faults_of(load(values)), HasSubstr("too many values; allowed: 2400000"));
  EXPECT_THAT(faults_of(load(anchors)), HasSubstr("no key can stand here"));
  EXPECT_THAT(faults_of(load(std::string(1'000'000, '\n'))), HasSubstr("the file is empty"));
  EXPECT_THAT(faults_of(load(maps)), HasSubstr("too many maps and lists; allowed: 400000"));
}

TEST(Limits, AMapHoldsNoMillionOfKeys) {
  std::string keys = "bridge: b\n";
  for (std::size_t i = 0; i <= kMaxKeys; ++i) keys += "k" + std::to_string(i) + ": 1\n";
  EXPECT_THAT(faults_of(load(keys)), HasSubstr("the map has too many keys; allowed: 1000"));
}

TEST(Limits, AnAliasMayRepeatWhatItNames) {
  const auto loaded = load(plant(
      "          - { name: a, at: \"holding:1\", type: int16, limits: &l { low: 1, high: 2 } }\n"
      "          - { name: b, at: \"holding:2\", type: int16, limits: *l }\n"));
  ASSERT_TRUE(loaded) << faults_of(loaded);
  EXPECT_EQ(loaded->buses[0].devices[0].channels[1].limits.high, 2);
}

}  // namespace
}  // namespace fieldcast::config
