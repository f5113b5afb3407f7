// The plan of one bus: the load of its channels and the prediction of the scheduler. Pure.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/plan/layout/cost.hpp"
#include "core/protocol/protocol.hpp"
#include "core/schedule/prediction.hpp"

namespace fieldcast::cli {

struct BusPlan {
  const BusSpec* bus = nullptr;                      // outlives the plan
  std::vector<std::unique_ptr<Protocol>> protocols;  // one for each device; `input` points to them
  Duration answer_time{};                            // assumed for every device
  ScheduleInput input;
  // For each channel in the order of the spec; empty if it is never read by itself.
  std::vector<std::optional<PointIndex>> point_of;
  Prediction prediction;
};

// REQUIRES: `bus` is valid as from the loader. Channels on the same items share a point.
// Write-only, on-demand and on-interest channels cause no load.
[[nodiscard]] BusPlan make_plan(const BusSpec& bus, Duration answer_time);

}  // namespace fieldcast::cli
