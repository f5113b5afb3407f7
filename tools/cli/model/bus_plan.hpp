// The plan of one bus: the load of its channels and the prediction of the scheduler. Pure.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/bus/bus_engine.hpp"
#include "core/model/bus_spec.hpp"
#include "core/plan/layout/cost.hpp"
#include "core/protocol/protocol.hpp"
#include "core/schedule/prediction.hpp"
#include "tools/sim/bus/wire.hpp"

namespace fieldcast::cli {

struct BusPlan {
  const BusSpec* bus = nullptr;                      // outlives the plan
  std::vector<std::unique_ptr<Protocol>> protocols;  // one for each device; `input` points to them
  Duration response_time{};                          // assumed for every device
  ScheduleInput input;
  // For each channel in the order of the spec; empty if it is never read by itself.
  std::vector<std::optional<PointIndex>> point_of;
  Prediction prediction;
};

// REQUIRES: `bus` is valid as from the loader. Channels on the same items share a point.
// Write-only, on-demand and on-interest channels cause no load.
[[nodiscard]] BusPlan make_plan(const BusSpec& bus, Duration response_time);

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
