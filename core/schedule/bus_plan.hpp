// The plan of one bus: the load of its channels, the prediction of the scheduler, and ways to make
// it feasible. Pure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/protocol/protocol.hpp"
#include "core/schedule/load_bound.hpp"
#include "core/schedule/prediction.hpp"

namespace fieldcast {

struct BusPlan {
  const BusSpec* bus = nullptr;                      // outlives the plan
  std::vector<std::unique_ptr<Protocol>> protocols;  // one for each device; `input` points to them
  Duration response_time{};                          // assumed for every device
  ScheduleInput input;
  // For each channel in the order of the spec; empty if it is never read by itself.
  std::vector<std::optional<PointIndex>> point_of;
  Prediction prediction;
  std::optional<LoadBound> bound;  // what any master needs; empty if not known
};

// REQUIRES: `bus` is valid as from the loader. Channels on the same items share a point.
// Write-only, on-demand and on-interest channels cause no load.
[[nodiscard]] BusPlan make_plan(const BusSpec& bus, Duration response_time);

// The least wire time that any master needs for the refreshes, as a share of what the plan needs.
// Empty if the plan is not feasible, or the least time is not known.
[[nodiscard]] std::optional<double> share_of_possible(const BusPlan& plan);

// Ways to make an infeasible plan feasible, one sentence each; empty if it is feasible.
[[nodiscard]] std::vector<std::string> advice(const BusPlan& plan);

}  // namespace fieldcast
