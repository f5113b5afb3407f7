// The plan of one bus: what its channels ask of the wire, and what the scheduler will make of it.
// Pure.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/model/spec.hpp"
#include "core/plan/point.hpp"
#include "core/protocol/protocol.hpp"
#include "core/schedule/prediction.hpp"

namespace fieldcast::cli {

struct BusPlan {
  const BusSpec* bus = nullptr;                      // outlives the plan
  std::vector<std::unique_ptr<Protocol>> protocols;  // one for each device; `input` points to them
  Duration answer_time{};                            // assumed of every device
  ScheduleInput input;
  // For each channel in the order of the spec; nothing: it is never read by itself.
  std::vector<std::optional<PointIndex>> point_of;
  Prediction prediction;
};

// REQUIRES: bus is as the loader makes it. Channels on the same items of a device share a point, as
// they do in the bus engine; write-only, on-demand and on-interest channels cost nothing until
// somebody asks.
[[nodiscard]] BusPlan make_plan(const BusSpec& bus, Duration answer_time);

}  // namespace fieldcast::cli
