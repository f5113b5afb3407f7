#include "config/calculate/calculations.hpp"

#include <gtest/gtest.h>

#include "config/document/limits.hpp"
#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

using namespace std::chrono_literals;

constexpr std::string_view kMeter =
    "          - { name: voltage, at: \"holding:0\", type: uint16, unit: V, refresh: 500ms }\n"
    "          - { name: current, at: \"holding:1\", type: uint16, unit: A, refresh: 2s }\n";

Loaded load(const std::string& text) { return load_text(text, "plant.yaml", {}); }

std::string with(const std::string& lines) { return plant(std::string(kMeter) + lines); }

// The value of the last channel of the first device for 230 and 4.
double last_value(const BridgeSpec& spec) {
  const double inputs[]{230, 4};
  const ChannelSpec& channel = spec.buses[0].devices[0].channels.back();
  return channel.calculation.value->compile()(inputs);
}

TEST(Calculations, AChannelOfTheDeviceHasItsInputsAndTheSlowestRefresh) {
  const auto loaded =
      load(with("          - { name: power, calculate: voltage * current, unit: W }\n"));
  ASSERT_TRUE(loaded) << faults_of(loaded);
  const ChannelSpec& power = loaded->buses[0].devices[0].channels[2];
  ASSERT_TRUE(power.calculation);
  EXPECT_EQ(power.calculation.value->inputs,
            (std::vector<ChannelPath>{{"bus", "d", "voltage"}, {"bus", "d", "current"}}));
  EXPECT_EQ(power.at, "= voltage * current");
  EXPECT_EQ(power.unit, "W");
  EXPECT_EQ(power.encoding.type, ValueType::kFloat64);
  EXPECT_EQ(power.access, Access::kReadOnly);
  EXPECT_EQ(promised_gap(power), 2s);
  EXPECT_EQ(last_value(*loaded), 920);
  EXPECT_EQ(power.calculation.value->remark, "");
}

TEST(Calculations, AHeartbeatIsTheLongestGapAndNoPromiseIsNoPromise) {
  const auto loaded = load(plant(
      "          - { name: a, at: \"holding:0\", type: int16, deadband: 1, heartbeat: 1min }\n"
      "          - { name: b, at: \"holding:1\", type: int16, mode: on-demand }\n"
      "          - { name: slow, calculate: a * 2 }\n"
      "          - { name: never, calculate: slow + b }\n"));
  ASSERT_TRUE(loaded) << faults_of(loaded);
  const auto& channels = loaded->buses[0].devices[0].channels;
  EXPECT_EQ(promised_gap(channels[2]), 1min);
  EXPECT_EQ(promised_gap(channels[3]), std::nullopt);
}

TEST(Calculations, InheritedDefaultsOfReadChannelsDoNotApply) {
  std::string text =
      with("          - { name: power, calculate: voltage * current, type: bool }\n");
  text.replace(text.find("    devices:"), 0,
               "    defaults: { access: read-write, mode: intensive, acquire: on-interest }\n");
  const auto loaded = load(text);
  ASSERT_TRUE(loaded) << faults_of(loaded);
  const ChannelSpec& power = loaded->buses[0].devices[0].channels[2];
  EXPECT_EQ(power.access, Access::kReadOnly);
  EXPECT_FALSE(power.on_interest);
  EXPECT_EQ(power.encoding.type, ValueType::kBool);
}

TEST(Calculations, AnInputMayBelongToAnotherBus) {
  const auto loaded = load(
      "bridge: b\nbuses:\n"
      "  - name: one\n    port: { serial: /dev/ttyS0 }\n    protocol: modbus-rtu\n    devices:\n"
      "      - name: d\n        address: 1\n        channels:\n"
      "          - { name: total, calculate: \"{two/e/part-1} + {two/e/part-2}\" }\n"
      "  - name: two\n    port: { serial: /dev/ttyS1 }\n    protocol: modbus-rtu\n    devices:\n"
      "      - name: e\n        address: 1\n        channels:\n"
      "          - { name: part-1, at: \"holding:0\", type: int16, unit: kW }\n"
      "          - { name: part-2, at: \"holding:1\", type: int16, unit: W }\n");
  ASSERT_TRUE(loaded) << faults_of(loaded);
  const ChannelSpec& total = loaded->buses[0].devices[0].channels[0];
  EXPECT_EQ(total.calculation.value->inputs[1], (ChannelPath{"two", "e", "part-2"}));
  EXPECT_EQ(total.calculation.value->remark,
            "one/d/total: + or - combines two/e/part-1 in kW with two/e/part-2 in W");
}

TEST(Calculations, ADeviceTemplateGivesEachDeviceItsOwn) {
  const auto loaded = load_text(
      "bridge: b\nbuses:\n"
      "  - name: one\n    port: { serial: /dev/ttyS0 }\n    protocol: modbus-rtu\n    devices:\n"
      "      - { name: d, address: 1, template: meter }\n"
      "      - { name: e, address: 2, template: meter }\n",
      "plant.yaml",
      texts({{"devices/meter.yaml",
              "channels:\n  - { name: u, at: \"holding:0\", type: int16 }\n"
              "  - { name: v, calculate: u / 10 }\n"}}));
  ASSERT_TRUE(loaded) << faults_of(loaded);
  const auto& devices = loaded->buses[0].devices;
  EXPECT_EQ(devices[0].channels[1].calculation.value->inputs[0], (ChannelPath{"one", "d", "u"}));
  EXPECT_EQ(devices[1].channels[1].calculation.value->inputs[0], (ChannelPath{"one", "e", "u"}));
}

TEST(Calculations, AReloadSeesTheSameExpressionAsUnchanged) {
  const std::string text = with("          - { name: power, calculate: voltage * current }\n");
  EXPECT_EQ(load(text)->buses, load(text)->buses);
  const std::string other = with("          - { name: power, calculate: voltage + current }\n");
  EXPECT_NE(load(text)->buses, load(other)->buses);
}

TEST(Calculations, AsManyAsAllowedLoadAndOneMoreIsAFault) {
  const auto text = [](std::size_t count) {
    std::string lines;
    for (std::size_t i = 0; i < count; ++i)
      lines += "          - { name: c" + std::to_string(i) + ", calculate: voltage * current }\n";
    return with(lines);
  };
  EXPECT_TRUE(load(text(kMaxCalculated)));
  const std::string faults = faults_of(load(text(kMaxCalculated + 1)));
  EXPECT_NE(faults.find("too many calculated channels; allowed: 10000 of a bridge"),
            std::string::npos)
      << faults;
}

TEST(Calculations, AChainMayHaveOnlySoManyLinks) {
  const auto text = [](std::size_t count) {
    std::string lines, before = "voltage";
    for (std::size_t i = 0; i < count; ++i) {
      const std::string name = "c" + std::to_string(i);
      lines += "          - { name: " + name + ", calculate: " + before + " + 1 }\n";
      before = name;
    }
    return with(lines);
  };
  EXPECT_TRUE(load(text(kMaxCalculationDepth)));
  EXPECT_NE(faults_of(load(text(kMaxCalculationDepth + 1))).find("that use each other"),
            std::string::npos);
}

}  // namespace
}  // namespace fieldcast::config
