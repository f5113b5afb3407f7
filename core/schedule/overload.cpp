#include "core/schedule/overload.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <tuple>

#include "core/model/make_protocol.hpp"
#include "core/schedule/bus_schedule.hpp"
#include "core/schedule/point_map.hpp"
#include "core/schedule/remedies.hpp"

namespace fieldcast {
namespace {

struct WiredBus {
  WiredBus(const BusSpec& bus, Duration answer_time) {
    std::vector<const Protocol*> pointers;
    for (const DeviceSpec& device : bus.devices) {
      protocols.push_back(make_protocol(device, line_of(bus.port)).value());
      pointers.push_back(protocols.back().get());
    }
    input = wire_input(bus, pointers, map_points(bus).points, answer_time);
  }
  std::vector<std::unique_ptr<Protocol>> protocols;
  ScheduleInput input;
};

struct Singly {
  double load = 0;      // infinite if a protocol has no size for such requests
  double tightest = 0;  // largest share of a refresh that the request of one point needs
};

Singly one_by_one(const ScheduleInput& input) {
  Singly sum;
  std::map<std::tuple<DeviceIndex, AreaIndex, std::uint32_t>, Duration> known;
  for (const Point& point : input.points) {
    if (point.mode == Mode::kOnDemand) continue;
    const auto [entry, added] =
        known.try_emplace({point.device, point.range.area, point.range.count});
    if (added) {
      const auto size = input.devices[point.device].protocol->size(ReadRequest{{point.range}});
      if (size)
        entry->second = wire_time(*size, input.line, input.silence, input.devices[point.device]);
      else
        sum.load = std::numeric_limits<double>::infinity();
    }
    const double share = to_seconds(entry->second) / to_seconds(point.refresh);
    sum.load += share;
    sum.tightest = std::max(sum.tightest, share);
  }
  return sum;
}

double planned_load(const ScheduleInput& input, const Singly& singly, Planner planner) {
  const double factor = std::max(1.0, singly.tightest);
  return factor * planned_load_of(stretched(input, factor), planner).load;
}

// A plan needs at most the time of separate requests, plus the cost of slots and alignment.
constexpr double kPlanIsSure = 0.5;

std::string rounded(double number) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), number < 10 ? "%.2f" : "%.0f", number);
  return buffer.data();
}

}  // namespace

std::optional<Overload> overload_of(const BusSpec& bus, Duration answer_time) {
  const WiredBus wired(bus, answer_time);
  const Singly singly = one_by_one(wired.input);
  if (singly.load <= kPlanIsSure) return std::nullopt;
  Overload overload{planned_load(wired.input, singly, bus.planner), 1, std::nullopt};
  if (overload.load <= 1) return std::nullopt;
  overload.stretch = std::max(singly.tightest, planned_load_of(wired.input, bus.planner).stretch);
  if (!has_line(bus.port)) return overload;
  for (const std::uint32_t baud : kStandardRates) {
    const auto faster = at_rate(wired.input, baud);
    if (faster && planned_load(*faster, one_by_one(*faster), bus.planner) <= 1) {
      overload.baud = baud;
      break;
    }
  }
  return overload;
}

std::optional<double> hopeless_load_of(const BusSpec& bus) {
  const WiredBus wired(bus, Duration::zero());
  const Singly singly = one_by_one(wired.input);
  if (singly.load <= kPlanIsSure * kHopelessLoad) return std::nullopt;
  const double load = planned_load(wired.input, singly, bus.planner);
  if (load <= kHopelessLoad) return std::nullopt;
  return load;
}

double asked_load(const ScheduleInput& input, Planner planner) {
  return planned_load(input, one_by_one(input), planner);
}

std::string to_text(const Overload& overload) {
  return "more is wanted than the wire carries, " + rounded(overload.load) +
         " times as much: refreshes will be up to " + rounded(overload.stretch) +
         " times as long as configured. Refresh less often, " +
         (overload.baud ? "run the line at " + std::to_string(*overload.baud) + " baud or more, "
                        : "") +
         "or split the bus; 'fieldcast plan' shows what is enough";
}

}  // namespace fieldcast
