#pragma once

#include <string>

#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

inline StationChannel channel_of(const std::string& name, const std::string& type = "float32",
                                 Access access = Access::kReadWrite) {
  StationChannel channel;
  channel.bridge = "line-7";
  channel.bus = "shop";
  channel.device = "press";
  channel.channel = name;
  channel.type = type;
  channel.unit = "°C";
  channel.at = "holding:100";
  channel.access = access;
  channel.refresh = std::chrono::milliseconds{500};
  return channel;
}

inline StationSample sample_of(const std::string& name, Value value,
                               std::int64_t acquired_ms = 1'000, Quality quality = Quality::kGood) {
  StationSample sample;
  sample.bus = "shop";
  sample.device = "press";
  sample.channel = name;
  sample.value = std::move(value);
  sample.quality = quality;
  sample.acquired_at = {acquired_ms * 1'000'000};
  sample.sequence = 1;
  return sample;
}

inline PathView path_of(std::string_view name) { return {"shop", "press", name}; }

inline StationDeviceStatus device_of(const std::string& name, std::int64_t reported_s,
                                     DeviceState state = DeviceState::kOnline) {
  StationDeviceStatus status;
  status.bus = "shop";
  status.device = name;
  status.report.state = state;
  status.reported_at = {reported_s * 1'000'000'000};
  return status;
}

inline StationBusStatus bus_of(const std::string& name) {
  StationBusStatus status;
  status.bridge = "line-7";
  status.bus = name;
  status.report.state = BusState::kRunning;
  return status;
}

inline StationReadPlan plan_of(const std::string& bus, double load = 0.25) {
  using std::chrono::microseconds;
  using std::chrono::milliseconds;
  PlanReport::Point point{"holding", 100, 2, {"force", "speed"}};
  point.period = milliseconds{188};
  point.phase = microseconds{106'500};
  point.worst_gap = milliseconds{190};
  PlanReport::Group group;
  group.device = "press";
  group.period = milliseconds{94};
  group.phase = microseconds{12'500};
  group.slack = microseconds{1'500};
  group.load = load;
  group.points = {point};
  StationReadPlan plan;
  plan.bus = bus;
  plan.plan.load = load;
  plan.plan.slot = milliseconds{94};
  plan.plan.hyperperiod = milliseconds{376};
  plan.plan.groups = {group};
  plan.in_force_since = {2'000'000'000};
  return plan;
}

}  // namespace fieldcast::web
