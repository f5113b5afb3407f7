// Measures protocols with lists of ranges: S7-200 PPI (items, two rounds), FINS in Host Link
// (multiple area read) and DTC (groups). Uses 300 registers of tests/maps in three stations as V
// words, DM words and int16 variables.
//
// usage: list_bench [intensive] [sustained]     (default: all)
#include <cstdio>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/dispatch/scheduler.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/dispatch/virtual_wire.hpp"
#include "tests/plan/best_requests.hpp"
#include "tests/plan/maps.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/engine_agreement.hpp"
#include "tools/progress/progress_line.hpp"

namespace {

using namespace fieldcast;
using namespace std::chrono_literals;

struct Family {
  const char* name;
  const char* at;  // its word area
  std::map<std::string, std::string> options;
  LineFormat line;
  std::uint32_t items;  // items of the area for one register
};
const Family kFamilies[] = {
    {"s7-ppi", "VB0", {}, {19200, 8, Parity::kEven, 1}, 2},
    {"omron-hostlink", "DM0", {{"mode", "fins"}}, {19200, 7, Parity::kEven, 2}, 1},
    {"dtc", "int16:0", {}, {19200, 8, Parity::kNone, 1}, 1}};

struct Bus {
  std::unique_ptr<Protocol> protocol;
  ScheduleInput input;
};

Bus bus_of(const Family& family, const test::Map& map, Duration delay, double stretch, Mode mode) {
  Bus bus;
  bus.protocol = *find_protocol(family.name)
                      ->make({.address = 1, .options = family.options, .line = family.line});
  const auto at = bus.protocol->parse_address(family.at);
  if (!at) throw std::runtime_error(std::string(family.at) + ": " + at.error().what);
  bus.input.line = family.line;
  bus.input.silence = silence_of(StandardSilence{}, family.line);
  bus.input.devices.assign(3, {.protocol = bus.protocol.get(), .response_time = delay});
  for (const test::MapRow& row : map) {
    Point point;
    point.device = static_cast<DeviceIndex>(row.unit - 1);
    point.range = {at->area, row.address * family.items, family.items};
    point.refresh = from_seconds(row.refresh * stretch);
    point.mode = mode;
    bus.input.points.push_back(point);
  }
  return bus;
}

// One round of all points of a device with a refresh up to `longest`.
Duration round_of(const Bus& bus, DeviceIndex device, Duration longest) {
  const auto sooner = [](const Range& a, const Range& b) { return a.first < b.first; };
  std::vector<Range> wanted;
  for (const Point& point : bus.input.points) {
    if (point.device == device && point.refresh <= longest) wanted.push_back(point.range);
  }
  if (wanted.empty()) return {};
  std::ranges::sort(wanted, sooner);
  const ListCost cost(bus.input.devices[device], bus.input.line, bus.input.silence);
  return test::best_requests(wanted, cost).cost;
}

// Reads each refresh class with the faster ones: sum of (best(up to R) - best(shorter than R)) / R.
double best_load(const Bus& bus) {
  std::set<Duration> classes;
  for (const Point& point : bus.input.points) classes.insert(point.refresh);
  double load = 0;
  for (DeviceIndex device = 0; device < bus.input.devices.size(); ++device) {
    Duration before{};
    for (const Duration refresh : classes) {
      const Duration round = round_of(bus, device, refresh);
      load += to_seconds(round - before) / to_seconds(refresh);
      before = round;
    }
  }
  return load;
}

void print_intensive(const Family& family, const test::Map& map, const char* name, Duration delay,
                     StepProgress& progress) {
  Bus bus = bus_of(family, map, delay, 1, Mode::kIntensive);
  for (Point& point : bus.input.points) point.refresh = 1s;
  Duration loop{};
  for (DeviceIndex device = 0; device < 3; ++device) loop += round_of(bus, device, Duration::max());
  const auto scheduler = make_scheduler(bus.input);
  test::VirtualWire wire(bus.input, *scheduler);
  wire.run(60s);
  wire.forget_gaps();
  wire.run(600s);
  progress.step();
  double refreshes = 0;
  for (PointIndex point = 0; point < bus.input.points.size(); ++point)
    refreshes += static_cast<double>(wire.seen(point).count);
  refreshes /= 600;
  const double most = static_cast<double>(bus.input.points.size()) / to_seconds(loop);
  progress.clear();
  std::printf(
      "%-15s %s %4.0f ms  %7.1f refreshes a second, the best requests %7.1f, ratio %.3f; %.1f "
      "requests a round\n",
      family.name, name, to_seconds(delay) * 1e3, refreshes, most, refreshes / most,
      static_cast<double>(wire.blocks()) / (refreshes * 600) *
          static_cast<double>(bus.input.points.size()));
}

struct Run {
  std::uint64_t missed = 0;
  double load = 0, planned = 0;
};
Run run(const Bus& bus, Duration length) {
  const auto scheduler = make_scheduler(bus.input);
  test::VirtualWire wire(bus.input, *scheduler);
  const Instant end = wire.now() + length;
  while (wire.now() < end && wire.missed() == 0) wire.run(length / 60);
  return {wire.missed() + wire.overdue(), wire.load(), scheduler->planned_load()};
}

constexpr double kMost = 1.2;  // of the best requests' load: more than can be sustained

void print_sustained(const Family& family, const test::Map& map, const char* name, Duration delay,
                     StepProgress& progress) {
  const double least = best_load(bus_of(family, map, delay, 1, Mode::kScheduled));
  Run at;
  const double holds = bench::greatest_share(kMost, progress, [&](double share) {
    const Run tried = run(bus_of(family, map, delay, least / share, Mode::kScheduled), 30min);
    if (tried.missed == 0) at = tried;
    return tried.missed == 0;
  });
  progress.clear();
  std::printf(
      "%-15s %s %4.0f ms  sustained load %.3f of the best requests; planned %.3f, spent %.3f\n",
      family.name, name, to_seconds(delay) * 1e3, holds, at.planned, at.load);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const bench::Arguments arguments(argc, argv);
  const auto wanted = [&](std::string_view name) {
    return arguments.size() == 0 || arguments.has(name);
  };
  const char* const names[] = {"map11", "map12", "map13", "map14"};
  const auto each = [&](const char* what, std::size_t steps, const auto& print) {
    StepProgress progress(what, std::size(kFamilies) * std::size(names) * 2 * steps);
    for (const Family& family : kFamilies) {
      for (const char* name : names) {
        const test::Map map = test::read_map(std::string(FIELDCAST_MAPS) + "/" + name + ".csv");
        for (const Duration delay : {Duration{2ms}, Duration{20ms}})
          print(family, map, name, delay, progress);
      }
    }
    std::puts("");
  };
  if (wanted("intensive")) {
    std::puts(
        "intensive mode, all registers alike, 19200 baud: refreshes a second against a loop over "
        "the best requests");
    each("intensive mode", 1, print_intensive);
  }
  if (wanted("sustained")) {
    std::puts(
        "scheduled mode, refreshes 100 ms to 10 s: the load that runs 30 minutes without a missed "
        "refresh");
    each("sustained load", bench::trials_below(kMost), print_sustained);
  }
}
