#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loader/loader.hpp"
#include "tests/plan/maps.hpp"
#include "tests/tools/cli/parsed_json.hpp"
#include "tools/cli/model/bus_plan.hpp"
#include "tools/cli/view/simulation_view.hpp"

namespace fieldcast::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

BridgeSpec load(const std::string& text) {
  auto loaded = config::load_text(text, "plant.yaml", {});
  if (!loaded) throw std::runtime_error(to_text(loaded.error().front()));
  return *std::move(loaded);
}

constexpr const char* kLine = R"(
bridge: test
buses:
  - name: line
    port: { serial: /dev/none, baud: 19200, format: 8E1 }
    protocol: modbus-rtu
    defaults: { refresh: 500ms, timeout: 100ms }
    devices:
      - name: a
        address: 1
        channels:
          - { name: x, at: "holding:1", type: uint16, refresh: 200ms }
          - { name: y, at: "holding:5", type: float32 }
          - { name: asked, at: "holding:9", type: uint16, mode: on-demand }
      - name: b
        address: 2
        channels: [ { name: z, at: "holding:400", type: int32 }, { name: on, at: "coil:3" } ]
)";

TEST(BusSimulation, WhatIsPredictedHappens) {
  const BridgeSpec spec = load(kLine);
  const BusPlan plan = make_plan(spec.buses[0], 5ms);
  ASSERT_TRUE(plan.prediction.feasible);
  const BusSimulation simulation = simulate(plan, {}, {10min, 1});
  EXPECT_EQ(simulation.bus.deadline_misses, 0u);
  EXPECT_NEAR(simulation.bus.measured_load, plan.prediction.load, 0.05 * plan.prediction.load);
  EXPECT_NEAR(to_seconds(simulation.devices[0].response_time), 0.005, 0.0005);
  for (const ChannelIndex channel : {0u, 1u, 3u, 4u}) {
    EXPECT_GT(simulation.channels[channel].readings, 1000u) << channel;
    EXPECT_GT(simulation.channels[channel].worst_gap, Duration::zero()) << channel;
  }
  EXPECT_EQ(simulation.channels[2].readings, 0u) << "nobody asked";
  EXPECT_THAT(simulation_lines(simulation, {}).front(), HasSubstr("10min simulated, seed 1: "));
  EXPECT_EQ(parsed(simulation_json(simulation))["channels"].size(), 4u);
}

TEST(BusSimulation, AModuleThatDialsInHasALineBehindIt) {
  std::string text = kLine;
  const std::string serial = "serial: /dev/none";
  text.replace(text.find(serial), serial.size(), "dial-in: 17");
  const BridgeSpec spec = load(text + "program: { modules: { listen: 127.0.0.1:4951 } }\n");
  const BusPlan plan = make_plan(spec.buses[0], 5ms);
  const BusSimulation simulation = simulate(plan, {}, {1min, 1});
  EXPECT_EQ(simulation.bus.deadline_misses, 0u);
  EXPECT_GT(simulation.channels[0].readings, 100u);
}

// 300 registers from 100 ms to 10 s, with half of the highest load of any master.
TEST(BusSimulation, PlanPredictionAndMeasurementAgreeOverTheMaps) {
  for (const int number : {11, 12, 13, 14}) {
    const test::Map map = test::read_map(std::string(FIELDCAST_SOURCE) + "/tests/maps/map" +
                                         std::to_string(number) + ".csv");
    const double stretch = test::least_load(map, 19200, 5ms) / 0.5;
    const BridgeSpec spec = load(test::configuration_of(map, stretch));
    const BusPlan plan = make_plan(spec.buses[0], 5ms);
    EXPECT_TRUE(plan.prediction.feasible) << number;
    const BusSimulation simulation = simulate(plan, {}, {3min, 1});
    EXPECT_EQ(simulation.bus.deadline_misses, 0u) << number;
    EXPECT_NEAR(simulation.bus.measured_load, plan.prediction.load, 0.05 * plan.prediction.load)
        << number;
    EXPECT_NEAR(simulation.bus.planned_load, simulation.bus.measured_load,
                0.05 * simulation.bus.measured_load)
        << number;
  }
}

constexpr Duration kSilence = 2'005'208ns;  // 3.5 characters of 11 bits at 19200 baud

// The plan starts from an assumed response time; the bus must do what `plan` shows.
TEST(BusSimulation, Map15KeepsAtFastResponsesWhatItsPlanForetells) {
  const test::Map map = test::read_map(std::string(FIELDCAST_SOURCE) + "/tests/maps/map15.csv");
  for (const Duration answer : {Duration{1us}, Duration{1ms}, kSilence, Duration{2500us}}) {
    const double stretch = test::least_load(map, 19200, answer - kSilence) / 0.5;
    const BridgeSpec spec = load(test::configuration_of(map, stretch));
    const BusPlan plan = make_plan(spec.buses[0], answer);
    EXPECT_TRUE(plan.prediction.feasible) << to_text(answer);
    const BusSimulation simulation = simulate(plan, {}, {3min, 1});
    EXPECT_EQ(simulation.bus.deadline_misses, 0u) << to_text(answer);
    EXPECT_NEAR(simulation.bus.measured_load, plan.prediction.load, 0.01 * plan.prediction.load);
  }
}

TEST(BusSimulation, WhatIsCalledFeasibleMissesNothingOnRandomMapsAtAnyResponseTime) {
  unsigned feasible = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const test::Map map = test::random_map(seed, 120);
    for (const Duration answer : {Duration{0}, Duration{2ms}, Duration{5ms}, Duration{20ms}}) {
      const double stretch = test::least_load(map, 19200, answer - kSilence) /
                             (0.35 + 0.03 * static_cast<double>(seed));
      const BridgeSpec spec = load(test::configuration_of(map, stretch));
      const BusPlan plan = make_plan(spec.buses[0], answer);
      if (!plan.prediction.feasible) continue;
      ++feasible;
      const BusSimulation simulation = simulate(plan, {}, {3min, 1});
      EXPECT_EQ(simulation.bus.deadline_misses, 0u)
          << seed << ", responses after " << to_text(answer);
    }
  }
  EXPECT_GE(feasible, 16u);
}

TEST(BusSimulation, EveryMissHasItsCauseAndItsChannel) {
  const BridgeSpec spec = load(kLine);
  const BusPlan plan = make_plan(spec.buses[0], 5ms);
  sim::BusFaults faults;
  faults.devices["b"].silence.push_back({60s, 90s});
  faults.unplugged.push_back({120s, 130s});
  const BusSimulation simulation = simulate(plan, faults, {5min, 1});
  EXPECT_GT(simulation.bus.misses[Cause::kNoResponse], 0u);
  EXPECT_GT(simulation.bus.misses[Cause::kPortClosed], 0u);
  EXPECT_EQ(simulation.bus.misses.total(), simulation.bus.deadline_misses);
  std::uint64_t sum = 0;
  for (const ChannelReport& channel : simulation.channels) sum += channel.missed;
  EXPECT_EQ(sum, simulation.bus.deadline_misses);
  // Only the closed port causes misses here: 10 s at 200 ms.
  EXPECT_NEAR(static_cast<double>(simulation.channels[0].missed), 50, 2);
  EXPECT_EQ(simulation.channels[0].last_miss, Cause::kPortClosed);
  const auto json = parsed(simulation_json(simulation));
  EXPECT_EQ(json["causes"]["NO_ANSWER"], simulation.bus.misses[Cause::kNoResponse]);
  EXPECT_GE(json["channels"][0]["missed"], json["channels"][1]["missed"])
      << "the worst comes first";
}

TEST(BusSimulation, OneSeedIsOneRunToTheLetter) {
  const BridgeSpec spec = load(kLine);
  const BusPlan plan = make_plan(spec.buses[0], 5ms);
  sim::BusFaults faults;
  faults.noise = 1e-4;
  faults.devices["a"].loss = 0.05;
  faults.devices["a"].delay.spread = 3ms;
  const auto run = [&](std::uint64_t seed) {
    return simulation_json(simulate(plan, faults, {2min, seed})).text();
  };
  EXPECT_EQ(run(7), run(7));
  EXPECT_NE(run(7), run(8));
}

// For a protocol declared in a file, the simulated device uses the declaration.
TEST(BusSimulation, DeclaredDevicesTakeTheirTimeOnTheWire) {
  auto loaded = config::load_file(std::string(FIELDCAST_SOURCE) + "/tests/tools/cli/declared.yaml");
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  const BusPlan plan = make_plan(loaded->buses[0], 5ms);
  ASSERT_TRUE(plan.prediction.feasible);
  const BusSimulation simulation = simulate(plan, {}, {5min, 1});
  EXPECT_EQ(simulation.bus.causes.total(), 0u);
  EXPECT_EQ(simulation.bus.deadline_misses, 0u);
  EXPECT_NEAR(simulation.bus.measured_load, plan.prediction.load, 0.05 * plan.prediction.load);

  sim::BusFaults faults;
  faults.devices["a"].loss = 0.1;
  faults.devices["a"].truncate = 0.1;
  faults.devices["a"].garble = 0.1;
  const BusSimulation faulty = simulate(plan, faults, {5min, 1});
  EXPECT_GT(faulty.bus.causes[Cause::kNoResponse], 0u);
  EXPECT_GT(faulty.bus.causes[Cause::kTruncated], 0u);
  EXPECT_GT(faulty.bus.causes[Cause::kChecksum], 0u);
}

}  // namespace
}  // namespace fieldcast::cli
