#include "tools/sim/bus/fault_file.hpp"

#include <gtest/gtest.h>

#include "config/loader/loader.hpp"

namespace fieldcast::sim {
namespace {

using namespace std::chrono_literals;

BridgeSpec plant() {
  BridgeSpec spec;
  BusSpec bus;
  bus.name = "shop";
  for (const char* name : {"press", "oven"}) {
    DeviceSpec device;
    device.name = name;
    device.protocol = "modbus-rtu";
    bus.devices.push_back(device);
  }
  spec.buses.push_back(bus);
  return spec;
}

std::string faults_of(std::string_view text) {
  const auto loaded = parse_faults(text, "f.yaml", plant());
  return loaded ? "none" : config::to_text(loaded.error());
}

TEST(FaultFile, EveryKeyArrives) {
  const auto loaded = parse_faults(R"(
buses:
  shop:
    noise: 1e-5
    echo: true
    babble: { rate: 2, length: 6 }
    foreign: 3
    unplug: [{ at: 10s, for: 3s }, { at: 60s }]
    fifo: 16
    devices:
      press:
        delay: { base: 5ms, spread: 1ms, spike: 50ms, spike-probability: 0.01 }
        loss: 0.1
        late: { probability: 0.2, by: 300ms }
        queue: true
        doubled: { probability: 0.25, after: 4ms }
        deaf: 30ms
        garble: 0.5
        truncate: 0.3
        stray: 0.4
        silence: [{ from: 1s, to: 2s }, { from: 9s }]
        exceptions: { area: holding, from: 107, to: 109, code: 4 }
        only-configured: true
)",
                                   "f.yaml", plant());
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  const BusFaults& bus = loaded->buses.at("shop");
  EXPECT_EQ(bus.noise, 1e-5);
  EXPECT_TRUE(bus.echo);
  EXPECT_EQ(bus.babble, 2);
  EXPECT_EQ(bus.babble_length, 6u);
  EXPECT_EQ(bus.foreign, 3);
  EXPECT_EQ(bus.fifo, 16u);
  ASSERT_EQ(bus.unplugged.size(), 2u);
  EXPECT_TRUE(bus.unplugged[0].holds(12s));
  EXPECT_FALSE(bus.unplugged[0].holds(13s));
  EXPECT_EQ(bus.unplugged[1].to, kForever);
  const DeviceFaults& press = bus.devices.at("press");
  EXPECT_EQ(press.delay.base, 5ms);
  EXPECT_EQ(press.delay.spread, 1ms);
  EXPECT_EQ(press.delay.spike, 50ms);
  EXPECT_EQ(press.delay.spike_probability, 0.01);
  EXPECT_EQ(press.loss, 0.1);
  EXPECT_EQ(press.late_probability, 0.2);
  EXPECT_EQ(press.late, 300ms);
  EXPECT_EQ(press.garble, 0.5);
  EXPECT_EQ(press.truncate, 0.3);
  EXPECT_EQ(press.stray, 0.4);
  ASSERT_EQ(press.silence.size(), 2u);
  EXPECT_TRUE(press.silence[1].holds(24h));
  ASSERT_EQ(press.refused.size(), 1u);
  EXPECT_EQ(press.refused[0].from, 107u);
  EXPECT_EQ(press.refused[0].to, 109u);
  EXPECT_EQ(press.refused[0].code, 4);
  EXPECT_TRUE(press.only_configured);
}

TEST(FaultFile, StarSpeaksOfAllAndNamesOverrideIt) {
  const auto loaded = parse_faults(
      "buses: { \"*\": { devices: { oven: { delay: 9ms }, \"*\": { delay: 4ms, loss: 0.5 } } } }",
      "f.yaml", plant());
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  const auto& devices = loaded->buses.at("shop").devices;
  EXPECT_EQ(devices.at("press").delay.base, 4ms);
  EXPECT_EQ(devices.at("oven").delay.base, 9ms);
  EXPECT_EQ(devices.at("oven").loss, 0.5);
}

TEST(FaultFile, EveryFaultIsNamedTogetherWithItsPlace) {
  const std::string faults = faults_of(
      "buses:\n"
      "  shop:\n"
      "    noize: 1\n"
      "    devices:\n"
      "      pres: {}\n"
      "      oven: { loss: 2, silence: never, late: { probability: 1 } }\n"
      "      press: { exceptions: [{ area: holdin, from: 5, to: 4 }] }\n"
      "  mill: {}\n");
  for (const char* part :
       {"f.yaml:3:5: unknown key 'noize'", "did you mean noise?", "f.yaml:5:7: no device 'pres'",
        "did you mean press?", "f.yaml:6:21: loss '2' is out of range",
        "silence 'never' is unknown", "'by' is missing", "area 'holdin' is unknown",
        "did you mean holding?", "the range ends before it begins", "f.yaml:8:3: no bus 'mill'"}) {
    EXPECT_NE(faults.find(part), std::string::npos) << part << "\nin\n" << faults;
  }
}

TEST(FaultFile, TheExampleFitsItsPlant) {
  const auto example = config::load_file(FIELDCAST_SIM_EXAMPLES "/plant.yaml");
  ASSERT_TRUE(example) << config::to_text(example.error());
  const auto loaded = load_faults(FIELDCAST_SIM_EXAMPLES "/faults.yaml", *example);
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  EXPECT_EQ(loaded->buses.at("press-shop").devices.at("press-2").refused.size(), 1u);
}

TEST(FaultFile, WrongShapesAreFaultsNotCrashes) {
  EXPECT_EQ(faults_of(""), "none");
  for (const char* text :
       {"[]", "x", "buses: 3", "buses: []", "buses: { shop: 3 }",
        "buses: { shop: { devices: [1] } }", "buses: { shop: { devices: { oven: [] } } }",
        "buses: { shop: { devices: { oven: { delay: [] } } } }",
        "buses: { shop: { devices: { oven: { silence: [3] } } } }",
        "buses: { shop: { unplug: 3 } }", "buses: {"}) {
    EXPECT_NE(faults_of(text), "none") << text;
  }
}

}  // namespace
}  // namespace fieldcast::sim
