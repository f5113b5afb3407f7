#include "core/schedule/overload.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "core/model/bus_spec.hpp"
#include "core/plan/wire_model.hpp"
#include "core/schedule/bus_schedule.hpp"

namespace fieldcast {

namespace {

struct WiredBus {
  WiredBus(const BusSpec& bus, Duration response_time) {
    std::vector<const Protocol*> pointers;
    for (const DeviceSpec& device : bus.devices) {
      protocols.push_back(make_protocol(device, line_of(bus.port)).value());
      pointers.push_back(protocols.back().get());
    }
    input = wire_input(bus, pointers, map_points(bus).points, response_time);
  }
  std::vector<std::unique_ptr<Protocol>> protocols;
  ScheduleInput input;
};

struct Singly {
  double load = 0;      // infinite if a protocol has no size for such requests
  double tightest = 0;  // largest share of a refresh that the request of one point needs
  Duration longest{};   // longest request of one point
  Duration shortest = Duration::max();  // shortest refresh
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
    sum.longest = std::max(sum.longest, entry->second);
    sum.shortest = std::min(sum.shortest, point.refresh);
  }
  return sum;
}

double planned_load(const ScheduleInput& input, const Singly& singly, Planner planner) {
  const double factor = std::max(1.0, singly.tightest);
  return factor * planned_load_of(stretched(input, factor), planner).load;
}

// A plan needs at most the time of separate requests, plus the cost of slots and alignment.
constexpr double kPlanIsSure = 0.5;
// A longer request, as a share of the shortest refresh, may delay other reads at any load.
constexpr double kDelaysNone = 0.25;
// More is overload, as for the engine (OverloadWatch).
constexpr double kStretched = 1.001;

struct Needed {
  double load = 0;     // share of the wire
  double stretch = 1;  // largest factor on a refresh, also by a long read that delays it
  [[nodiscard]] bool fits() const { return load <= 1 && stretch <= kStretched; }
};

Needed needed_by(const ScheduleInput& input, const Singly& singly, Planner planner) {
  const WireModel wire(input, planner);
  PlanBasis basis{wire, planned_points(input, wire.layout)};
  Grouping grouping = group_points(basis);
  const ReadPlan plan = std::move(make_plans(std::move(basis), std::move(grouping)).front());
  Needed needed{plan.planned_load(), std::max(singly.tightest, plan.stretch)};
  if (singly.tightest > 1) needed.load = planned_load(input, singly, planner);
  if (!needed.fits()) return needed;
  for (OrderIndex index = 0; index < plan.points.size(); ++index) {
    const Duration gap = plan.points[index].worst_gap.value_or(Duration::zero());
    const Duration refresh = input.points[plan.order[index]].refresh;
    needed.stretch = std::max(needed.stretch, to_seconds(gap) / to_seconds(refresh));
  }
  return needed;
}

std::string rounded(double number) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), number < 10 ? "%.2f" : "%.0f", number);
  return buffer.data();
}

}  // namespace

std::optional<Overload> overload_of(const BusSpec& bus, Duration response_time) {
  const WiredBus wired(bus, response_time);
  const Singly singly = one_by_one(wired.input);
  const bool delays_none = to_seconds(singly.longest) <= kDelaysNone * to_seconds(singly.shortest);
  if (singly.load <= kPlanIsSure && delays_none) return std::nullopt;
  const Needed needed = needed_by(wired.input, singly, bus.planner);
  if (needed.fits()) return std::nullopt;
  Overload overload{needed.load, needed.stretch, std::nullopt};
  if (!has_line(bus.port)) return overload;
  for (const std::uint32_t baud : kStandardRates) {
    const auto faster = at_rate(wired.input, baud);
    if (faster && needed_by(*faster, one_by_one(*faster), bus.planner).fits()) {
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
  return (overload.load > 1
              ? "more is wanted than the wire carries, " + rounded(overload.load) + " times as much"
              : "the refreshes do not fit together on the wire, although they need " +
                    rounded(100 * overload.load) + " % of it") +
         ": refreshes will be up to " + rounded(overload.stretch) +
         " times as long as configured. Refresh less often, " +
         (overload.baud ? "run the line at " + std::to_string(*overload.baud) + " baud or more, "
                        : "") +
         "or split the bus; 'fieldcast plan' shows what is enough";
}

namespace {

// The smallest feasible factor, within two per cent.
std::optional<double> stretch_that_works(const ScheduleInput& input, const Works& works,
                                         double load) {
  double works_at = std::max(1.05, load), fails_at = 1;
  for (int doubling = 0; !works(stretched(input, works_at)); ++doubling) {
    if (doubling == 8) return std::nullopt;
    fails_at = works_at;
    works_at *= doubling < 3 ? 1.25 : 2;
  }
  while (works_at > fails_at * 1.02) {
    const double middle = (works_at + fails_at) / 2;
    (works(stretched(input, middle)) ? works_at : fails_at) = middle;
  }
  return works_at;
}

std::optional<std::uint32_t> baud_that_works(const ScheduleInput& input, const Works& works) {
  for (const std::uint32_t baud : kStandardRates) {
    const auto faster = at_rate(input, baud);
    if (faster && works(*faster)) return baud;
  }
  return std::nullopt;
}

ScheduleInput part_of(const ScheduleInput& input, const std::vector<DeviceIndex>& devices) {
  ScheduleInput part = input;
  std::erase_if(part.points, [&](const Point& point) {
    return std::ranges::find(devices, point.device) == devices.end();
  });
  return part;
}

// The heaviest first, each to the least loaded line.
std::optional<std::size_t> buses_that_work(const ScheduleInput& input, const Works& works,
                                           Planner planner) {
  constexpr std::size_t kMostBuses = 8;
  std::vector<std::pair<double, DeviceIndex>> heaviest;
  for (DeviceIndex device = 0; device < input.devices.size(); ++device) {
    const ScheduleInput alone = part_of(input, {device});
    if (!alone.points.empty()) heaviest.emplace_back(asked_load(alone, planner), device);
  }
  std::ranges::sort(heaviest, std::greater<>{});
  for (std::size_t count = 2; count <= std::min(kMostBuses, heaviest.size()); ++count) {
    std::vector<std::pair<double, std::vector<DeviceIndex>>> lines(count);
    for (const auto& [load, device] : heaviest) {
      auto& least =
          *std::ranges::min_element(lines, {}, [](const auto& line) { return line.first; });
      least.first += load;
      least.second.push_back(device);
    }
    if (std::ranges::all_of(lines, [&](const auto& line) {
          return line.first < 1 && works(part_of(input, line.second));
        }))
      return count;
  }
  return std::nullopt;
}

// Returns true if the change affects a device and makes the bus feasible.
template <typename Change>
bool works_with(const ScheduleInput& input, const Works& works, Change change) {
  ScheduleInput other = input;
  bool changed = false;
  for (DeviceTiming& device : other.devices) changed = change(device) || changed;
  return changed && works(other);
}

// The next longer of 1, 2, 5, 10, ... in the decade of the refresh.
Duration next_refresh(Duration refresh) {
  Duration decade{1};
  while (decade * 10 <= refresh) decade *= 10;
  for (const int step : {2, 5}) {
    if (decade * step > refresh) return decade * step;
  }
  return decade * 10;
}

std::vector<SlowerPoints> slower_that_works(const ScheduleInput& input, const Works& works) {
  constexpr int kMostSteps = 20;
  ScheduleInput slower = input;
  bool found = false;
  for (int step = 0; step < kMostSteps && !found; ++step) {
    Duration shortest = Duration::max();
    for (const Point& point : slower.points) {
      if (point.mode != Mode::kOnDemand) shortest = std::min(shortest, point.refresh);
    }
    if (shortest > std::chrono::hours{1}) return {};
    for (Point& point : slower.points) {
      if (point.refresh == shortest) point.refresh = next_refresh(shortest);
    }
    found = works(slower);
  }
  if (!found) return {};
  std::map<Duration, SlowerPoints> groups;
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    const Duration from = input.points[point].refresh, to = slower.points[point].refresh;
    if (from == to || input.points[point].mode == Mode::kOnDemand) continue;
    SlowerPoints& group = groups[from];
    group.from = from;
    group.to = to;
    group.points.push_back(point);
  }
  std::vector<SlowerPoints> result;
  result.reserve(groups.size());
  for (auto& [from, group] : groups) result.push_back(std::move(group));
  return result;
}

}  // namespace

ScheduleInput stretched(const ScheduleInput& input, double factor) {
  ScheduleInput result = input;
  for (Point& point : result.points)
    point.refresh = from_seconds(to_seconds(point.refresh) * factor);
  return result;
}

std::optional<ScheduleInput> at_rate(const ScheduleInput& input, std::uint32_t baud) {
  if (baud <= input.line.baud) return std::nullopt;
  ScheduleInput faster = input;
  faster.line.baud = baud;
  // Silences shrink with the characters, but not below 1.75 ms (Modbus over Serial Line V1.02,
  // 2.5.1.1) unless they were shorter.
  const Duration shrunk{input.silence.count() * input.line.baud / baud};
  faster.silence =
      std::max(shrunk, std::min<Duration>(input.silence, std::chrono::microseconds{1750}));
  return faster;
}

Remedies find_remedies(const ScheduleInput& input, const Works& works, double load,
                       Planner planner) {
  Remedies remedies;
  remedies.stretch = stretch_that_works(input, works, load);
  remedies.baud = baud_that_works(input, works);
  remedies.slower = slower_that_works(input, works);
  remedies.longer_reads = works_with(input, works, [](DeviceTiming& device) {
    const bool limited = device.max_block != 0 || device.max_gap;
    device.max_block = 0;
    device.max_gap.reset();
    return limited;
  });
  remedies.no_pause = works_with(input, works, [](DeviceTiming& device) {
    return std::exchange(device.pause, Duration{}) > Duration{};
  });
  remedies.buses = buses_that_work(input, works, planner);
  return remedies;
}

}  // namespace fieldcast
