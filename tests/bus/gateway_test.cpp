// Clients of a gateway on a simulated line of 19 200 baud, in virtual time.
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "core/schedule/bus_schedule.hpp"
#include "core/schedule/prediction.hpp"
#include "tests/bus/plant.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

BusSpec plant_with_gateway(const std::string& defaults, int devices = 4) {
  BusSpec spec = plant(devices, 20, defaults);
  spec.gateway.emplace();
  return spec;
}

Command read_of(const std::string& device, unsigned first, std::uint32_t count,
                const std::string& client = "client") {
  Command command;
  command.requester = client;
  command.device = device;
  command.operation = Operation::kAcquire;
  command.target = AddressTarget{"holding:" + std::to_string(first), {}};
  command.count = count;
  command.gateway = true;
  return command;
}

struct Load {
  std::uint64_t requests = 0, done = 0, busy = 0, wrong = 0, misses = 0;
  double utilisation = 0;  // mean
};

// Eight clients, each with a request every 100 ms for a range of its own, for a minute.
Load run_clients(const std::string& defaults, std::uint32_t count, Duration max_age) {
  const BusSpec spec = plant_with_gateway(defaults);
  VirtualBus bus(spec, {}, 5);
  fill(bus, spec);
  const auto before = bus.engine().bus_report(bus.now());
  const std::size_t filled = bus.results().size();
  bus.watch_from_now();
  Load load;
  std::map<std::uint64_t, std::uint64_t> asked;  // first value of each request
  double busy = 0;
  for (int tenth = 0; tenth < 600; ++tenth) {
    for (unsigned client = 0; client < 8; ++client) {
      const unsigned device = client % 4, offset = client / 4 * 2;
      Command command = read_of("unit-" + std::to_string(device + 1), 100 + offset, count,
                                "client " + std::to_string(client));
      command.expires = bus.now() + 1s;
      command.max_age = max_age;
      bus.command(command);
      asked[bus.commands_sent()] = value_of(device * 20 + offset / 2);
      bus.run_until(bus.now() + 12500us);
    }
    if (tenth % 10 == 9) busy += bus.engine().bus_report(bus.now()).utilisation;
  }
  bus.run_until(bus.now() + 2s);
  load.misses = bus.engine().bus_report(bus.now()).deadline_misses - before.deadline_misses;
  load.utilisation = busy / 60;
  load.requests = bus.results().size() - filled;
  for (const auto& [id, first] : asked) {
    const auto found = bus.results().find(id);
    if (found == bus.results().end()) continue;
    const CommandResult& result = found->second.front();
    load.done += result.state == CommandState::kDone;
    load.busy += result.state == CommandState::kExpired;
    load.wrong += result.state == CommandState::kDone &&
                  (result.values.size() != count || result.values[0] != Value{first});
  }
  for (const auto& channel : bus.channels()) EXPECT_LE(channel.longest_gap, 2s);
  return load;
}

TEST(Gateway, ClientsUseTheRestOfTheWireAndThePlanKeepsEveryRefresh) {
  const std::pair<const char*, std::uint32_t> kLoads[] = {
      {"refresh: 2s", 40}, {"refresh: 1s", 40}, {"refresh: 500ms", 10}};
  for (const auto& [defaults, count] : kLoads) {
    const Load load = run_clients(defaults, count, 0ms);
    EXPECT_EQ(load.requests, 4800u) << "one result for each";
    EXPECT_EQ(load.done + load.busy, 4800u);
    EXPECT_EQ(load.misses, 0u) << defaults;
    EXPECT_EQ(load.wrong, 0u) << defaults;
    EXPECT_GE(load.utilisation, 0.97) << defaults;
    EXPECT_GT(load.done, 0u);
  }
}

// Whether the plan keeps every refresh, also 5 % shorter ones, at this response time.
bool is_kept(const BusSpec& spec, Duration response_time) {
  const LineFormat line = line_of(spec.port);
  std::vector<std::unique_ptr<Protocol>> owned;
  std::vector<const Protocol*> protocols;
  for (const DeviceSpec& device : spec.devices) {
    owned.push_back(*make_protocol(device, line));
    protocols.push_back(owned.back().get());
  }
  PredictionOptions options;
  options.remedies = false;
  const Prediction found =
      predict(schedule_input(spec, protocols, map_points(spec).points, response_time), options);
  return found.feasible && !found.narrow;
}

struct RandomPlant {
  BusSpec spec;
  sim::BusFaults faults;
  Duration longest_response;
};

// Devices with different refreshes, modes and numbers of channels.
RandomPlant random_plant(std::mt19937_64& random) {
  const auto any = [&](std::initializer_list<int> of) {
    return *(of.begin() + static_cast<std::ptrdiff_t>(random() % of.size()));
  };
  RandomPlant plant{plant_with_gateway("refresh: 1s", any({1, 2, 4, 8})), {}, {}};
  const std::chrono::milliseconds base{any({1, 5, 20})};
  plant.longest_response = base + base / 2;
  for (DeviceSpec& device : plant.spec.devices) {
    plant.faults.devices[device.name].delay = {base, base / 2, 0, {}};
    device.channels.resize(static_cast<std::size_t>(any({1, 5, 20})));
    for (ChannelSpec& channel : device.channels) {
      channel.refresh = std::chrono::milliseconds{any({200, 300, 500, 1000, 3000})};
      channel.mode = any({0, 0, 0, 1}) == 0 ? Mode::kScheduled : Mode::kIntensive;
    }
  }
  return plant;
}

// Reads of random length, more than the wire carries, for a minute. Returns the mean use of it.
// If the device is not `known`, the reads are refused, and only their arrival disturbs the bus.
double read_at_random(VirtualBus& bus, const BusSpec& spec, bool known, std::mt19937_64& random) {
  double used = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto device = static_cast<std::size_t>(random() % spec.devices.size());
    Command command =
        read_of(spec.devices[device].name, static_cast<unsigned>(random() % 1000),
                static_cast<std::uint32_t>(1 + random() % 100), "client " + std::to_string(i % 8));
    command.expires = bus.now() + 1s;
    if (!known) command.device = "nobody";
    bus.command(command);
    bus.run_until(bus.now() + 20ms);
    if (i % 50 == 49) used += bus.engine().bus_report(bus.now()).utilisation / 60;
  }
  return used;
}

TEST(Gateway, ClientsCostNoRefreshThatThePlanKeeps) {
  int kept = 0;
  std::vector<std::uint64_t> seeds(30);
  std::iota(seeds.begin(), seeds.end(), 1);
  seeds.push_back(282);  // intensive points of a group of scheduled ones
  for (const std::uint64_t seed : seeds) {
    std::mt19937_64 random(seed);
    const RandomPlant plant = random_plant(random);
    if (!is_kept(plant.spec, plant.longest_response)) continue;
    const auto run = [&](bool clients) {
      VirtualBus bus(plant.spec, plant.faults, seed);
      bus.run_until(Instant{30s});
      const std::uint64_t before = bus.engine().bus_report(bus.now()).deadline_misses;
      const double used = read_at_random(bus, plant.spec, clients, random);
      bus.run_until(Instant{90s});
      return std::pair(bus.engine().bus_report(bus.now()).deadline_misses - before, used);
    };
    if (run(false).first != 0) continue;
    ++kept;
    const auto [misses, used] = run(true);
    EXPECT_EQ(misses, 0u) << "seed " << seed << ", wire " << used;
  }
  EXPECT_GT(kept, 10);
}

TEST(Gateway, StoredResponsesServeAllClients) {
  const Load load = run_clients("refresh: 1s", 3, 500ms);
  EXPECT_EQ(load.done, 4800u);
  EXPECT_EQ(load.misses, 0u);
  EXPECT_EQ(load.wrong, 0u);
}

TEST(Gateway, AnIntensiveBusKeepsItsRefreshToo) {
  const Load load = run_clients("refresh: 1s, mode: intensive", 10, 0ms);
  EXPECT_EQ(load.misses, 0u);
  EXPECT_EQ(load.wrong, 0u);
  EXPECT_GT(load.done, 1000u);
}

// On a bus that needs its whole wire, long reads do not fit between those of the plan.
TEST(Gateway, OnAFullWireClientsHaveTheirShare) {
  for (const double share : {0.0, 0.1}) {
    BusSpec spec = plant_with_gateway("refresh: 50ms");
    spec.gateway->share = share;
    VirtualBus bus(spec, {}, 5);
    bus.run_until(Instant{10s});
    for (int i = 0; i < 600; ++i) {
      Command command = read_of("unit-1", 3000, 100);
      command.expires = bus.now() + 1s;
      bus.command(command);
      bus.run_until(bus.now() + 100ms);
    }
    std::uint64_t done = 0;
    for (const auto& [id, results] : bus.results())
      done += results.front().state == CommandState::kDone;
    EXPECT_EQ(done > 0, share > 0) << done;
    EXPECT_LT(done, 600u);
  }
}

TEST(Gateway, AWriteMakesStoredResponsesInvalid) {
  const BusSpec spec = plant_with_gateway("refresh: 1h, mode: on-demand", 1);
  VirtualBus bus(spec, {}, 5);
  fill(bus, spec);
  const auto read = [&] {
    Command command = read_of("unit-1", 100, 1);
    command.max_age = 10s;
    bus.command(command);
    bus.run_until(bus.now() + 1s);
    return bus.results().at(bus.commands_sent()).front().values;
  };
  const std::uint64_t sends = bus.sends();
  EXPECT_EQ(read(), std::vector<Value>{Value{value_of(0)}});
  EXPECT_EQ(read(), std::vector<Value>{Value{value_of(0)}});
  EXPECT_EQ(bus.sends(), sends + 1) << "the second is served from the first";
  bus.judge = {};
  bus.command(write_of(spec, 0, 4711));
  bus.run_until(bus.now() + 1s);
  EXPECT_EQ(read(), std::vector<Value>{Value{std::uint64_t{4711}}});
}

}  // namespace
}  // namespace fieldcast::test
