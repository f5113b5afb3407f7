// One bus of a configuration in virtual time: the whole engine against simulated devices, and what
// came of each channel. Pure.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/bus/bus_engine.hpp"
#include "core/schedule/prediction.hpp"
#include "tools/cli/model/bus_plan.hpp"
#include "tools/sim/bus/faults.hpp"

namespace fieldcast::cli {

struct SimulationOptions {
  Duration length = std::chrono::hours{1};
  std::uint64_t seed = 1;
};

// Told a hundred times or so, with the share of the virtual time that is over. Changes nothing.
using OnSimulated = std::function<void(double share)>;

struct BusSimulation {
  const BusPlan* plan = nullptr;  // what was predicted; outlives the simulation
  SimulationOptions options;
  BusReport bus;                        // its measured load covers the whole run
  std::vector<DeviceReport> devices;    // in the order of the spec
  std::vector<ChannelReport> channels;  // in the order of the spec
  std::uint64_t fingerprint = 0;  // two runs share it only when everything they did was the same
};

// Devices answer after the plan's answer time, unless the faults say otherwise. Throws
// std::runtime_error when the bus cannot be simulated. One seed, one run.
[[nodiscard]] BusSimulation simulate(const BusPlan& plan, const sim::BusFaults& faults,
                                     const SimulationOptions& options,
                                     const OnSimulated& on_simulated = {});

}  // namespace fieldcast::cli
