#include <gtest/gtest.h>

#include <random>

#include "tests/bus/plant.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// Noise, loss, late responses, silences, an unplugged port and commands, for many seeds.
class Storm : public testing::TestWithParam<int> {};

TEST_P(Storm, NoWrongValueNoLostCommandNoStarvation) {
  const auto seed = static_cast<std::uint64_t>(GetParam());
  BusSpec spec = plant(5, 10, "refresh: 2s, timeout: 150ms, retries: 1");
  if (seed % 5 == 0) spec.planner = Planner::kDynamicBlocks;
  sim::BusFaults faults;
  faults.noise = 2e-5;
  faults.devices["unit-1"].loss = 0.05;
  faults.devices["unit-2"].late_probability = 0.05;
  faults.devices["unit-2"].late = 90ms;
  faults.devices["unit-3"].truncate = 0.05;
  faults.devices["unit-3"].stray = 0.1;
  faults.devices["unit-4"].garble = 0.2;
  // Registers are filled while the plant is healthy. Later each device is dead for a while.
  const Duration filled = 60s;
  faults.devices["unit-5"].silence.push_back({filled + 60s, filled + 120s});
  VirtualBus bus(spec, faults, seed);
  std::mt19937_64 random(seed);
  for (ChannelIndex c = 0; c < bus.channels().size(); ++c) {
    Command command = write_of(spec, c, value_of(c));
    command.verify = true;
    for (int attempt = 0; attempt < 20; ++attempt) {
      bus.command(command);
      bus.run_until(bus.now() + 800ms);
      if (bus.results().at(bus.commands_sent()).front().state == CommandState::kVerified) break;
    }
    ASSERT_EQ(bus.results().at(bus.commands_sent()).front().state, CommandState::kVerified)
        << bus.results().at(bus.commands_sent()).front().reason;
  }
  bus.run_until(bus.now() + 5s);
  bus.judge = [](ChannelIndex channel, const Value& value) {
    if (std::get<std::uint64_t>(value) == value_of(channel)) return std::string{};
    return "channel " + std::to_string(channel) + " shows " + to_text(value) +
           ", its register holds " + std::to_string(value_of(channel));
  };
  bus.watch_from_now();
  const Instant end = bus.now() + 10min;
  const Instant unplugged = bus.now() + 200s;
  bool out = false;
  while (bus.now() < end) {
    bus.run_until(bus.now() + Duration{static_cast<std::int64_t>(random() % 2'000'000'000)});
    if (!out && bus.now() > unplugged && bus.now() < unplugged + 20s) {
      bus.unplug();
      bus.run_until(bus.now() + 15s);
      bus.plug();
      out = true;
    }
    const auto channel = static_cast<ChannelIndex>(random() % bus.channels().size());
    Command command = write_of(spec, channel, value_of(channel));
    command.verify = random() % 2 == 0;
    if (random() % 4 == 0) {
      command.operation = Operation::kAcquire;
      command.values.clear();
    }
    command.expires = bus.now() + 5s;
    bus.command(std::move(command));
  }
  bus.stop();
  for (std::uint64_t id = 1; id <= bus.commands_sent(); ++id)
    EXPECT_EQ(bus.results().count(id), 1u) << "command " << id << " was never answered";
  for (ChannelIndex c = 0; c < bus.channels().size(); ++c)
    EXPECT_GT(bus.channels()[c].good, 100u) << "channel " << c << " starves";
}

INSTANTIATE_TEST_SUITE_P(Seeds, Storm, testing::Range(1, 41));

}  // namespace
}  // namespace fieldcast::test
