// The simulation of one bus in virtual time. Pure.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/bus/bus_engine.hpp"
#include "core/model/bus_spec.hpp"
#include "core/schedule/bus_plan.hpp"
#include "tools/sim/bus/wire.hpp"

namespace fieldcast::cli {

using fieldcast::BusPlan;
using fieldcast::make_plan;

struct SimulationOptions {
  Duration length = std::chrono::hours{1};
  std::uint64_t seed = 1;
};

// Called about a hundred times with the finished share.
using OnSimulated = std::function<void(double share)>;

struct BusSimulation {
  const BusPlan* plan = nullptr;  // the prediction; outlives the simulation
  SimulationOptions options;
  BusReport bus;                        // its measured load covers the whole run
  std::vector<DeviceReport> devices;    // in the order of the spec
  std::vector<ChannelReport> channels;  // in the order of the spec
  std::uint64_t fingerprint = 0;        // equal in two runs only if they did the same
};

// Runs the whole engine of a bus against simulated devices in virtual time. Pure.
// Devices respond after the plan's response time, unless the faults differ. Deterministic for a
// seed. Throws std::runtime_error.
[[nodiscard]] BusSimulation simulate(const BusPlan& plan, const sim::BusFaults& faults,
                                     const SimulationOptions& options,
                                     const OnSimulated& on_simulated = {});

}  // namespace fieldcast::cli
