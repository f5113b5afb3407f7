// Reads the maps of tests/maps on pseudo-terminals with wire timing, at 19200 and 115200 baud and
// at 0.5 and 0.6 of the load bound (tests/plan/maps.hpp). Counts missed refreshes. Runs all four
// lines concurrently, unless --one-by-one, --baud or --load select otherwise.
//
// usage: endurance_bench [--seconds N] [--map 11|12|13|14] [--one-by-one] [--baud N] [--load SHARE]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "tests/plan/maps.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {
namespace {

constexpr auto kResponseTime = std::chrono::milliseconds(2);  // of the simulated devices
constexpr double kSettle = 20;  // seconds; nearly twice the slowest refresh of a map

struct Line {
  std::uint32_t baud;
  double load;
  [[nodiscard]] std::string name() const {
    return "line-" + std::to_string(baud) + '-' +
           std::to_string(static_cast<int>(load * 100 + 0.5));
  }
};

std::string bus_of(const Line& line, const test::Map& map,
                   std::map<std::string, double>& refreshes) {
  const double stretch = test::least_load(map, line.baud, kResponseTime) / line.load;
  std::string devices;
  unsigned unit = 0;
  for (const test::MapRow& row : map) {  // sorted by unit
    if (row.unit != unit) {
      unit = row.unit;
      devices += "      - name: unit-" + std::to_string(unit) +
                 "\n        address: " + std::to_string(unit) + "\n        channels:\n";
    }
    const long long refresh = static_cast<long long>(row.refresh * stretch * 1e6);
    devices += "          - { name: r" + std::to_string(row.address) +
               ", at: \"holding:" + std::to_string(row.address) +
               "\", type: uint16, refresh: " + std::to_string(refresh) + "us }\n";
    refreshes[line.name() + "/unit-" + std::to_string(unit) + "/r" + std::to_string(row.address)] =
        static_cast<double>(refresh) * 1e-6;
  }
  return serial_bus(line.name(), line.baud, "silence: 3.5c", devices);
}

std::string causes_of(const CauseCounts& causes) {
  std::string text;
  for (const auto& [cause, count] : causes)
    text += (text.empty() ? "  " : ", ") + cause + ' ' + std::to_string(count);
  return text;
}

void measure(const std::vector<Line>& lines, const test::Map& map, double seconds) {
  std::map<std::string, double> refreshes;
  std::string buses;
  for (const Line& line : lines) buses += bus_of(line, map, refreshes);
  Plant plant(buses);
  plant.start_simulator();
  plant.listen();
  plant.start_bridge();
  // A channel is first read within its refresh, which a full line makes longer.
  double slowest = 0;
  for (const auto& [name, refresh] : refreshes) slowest = std::max(slowest, refresh);
  plant.wait_until_seen(refreshes.size(), 1.3 * slowest);
  let_run(kSettle);
  const auto before = plant.buses();
  plant.forget_samples();
  let_run(seconds);
  const auto after = plant.buses();
  const auto seen = plant.seen();
  for (const Line& line : lines) {
    double refreshed = 0, tightest = 0;
    for (const auto& [name, channel] : seen) {
      if (!name.starts_with(line.name() + '/')) continue;
      refreshed += static_cast<double>(channel.samples);
      tightest =
          std::max(tightest, static_cast<double>(channel.longest_gap) * 1e-9 / refreshes.at(name));
    }
    const BusReport& report = after.at(line.name()).report;
    const auto missed = report.deadline_misses - before.at(line.name()).report.deadline_misses;
    std::printf(
        "%6u baud, load %.2f, %zu channels, %.0f s: %8.0f refreshes, %llu missed; longest gap %.3f "
        "of its refresh; planned %.3f, measured %.3f%s\n",
        line.baud, line.load, map.size(), seconds, refreshed,
        static_cast<unsigned long long>(missed), tightest, report.planned_load,
        report.measured_load, causes_of(after.at(line.name()).causes).c_str());
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("endurance_bench", argc, argv, [](const Arguments& arguments) {
    const double seconds = arguments.number("--seconds", 60.0);
    const std::string number = arguments.text("--map", "11");
    const auto baud = arguments.number("--baud", 0u);
    const double load = arguments.number("--load", 0.0);
    fieldcast::test::Map map =
        fieldcast::test::read_map(std::string(FIELDCAST_MAPS) + "/map" + number + ".csv");
    std::ranges::stable_sort(map, {}, &fieldcast::test::MapRow::unit);
    std::vector<Line> lines{{19200, 0.5}, {115200, 0.5}, {19200, 0.6}, {115200, 0.6}};
    std::erase_if(lines, [&](const Line& line) {
      return (baud != 0 && line.baud != baud) || (load > 0 && std::abs(line.load - load) > 1e-6);
    });
    if (lines.empty())
      throw std::runtime_error("no such line: --baud is 19200 or 115200, --load 0.5 or 0.6");
    if (arguments.has("--one-by-one")) {
      for (const Line& line : lines) measure({line}, map, seconds);
    } else {
      measure(lines, map, seconds);
    }
  });
}
