// Reads the maps of tests/maps on pseudo-terminals with wire timing, at 19200 and 115200 baud and
// at 0.5 and 0.6 of the load bound (tests/plan/maps.hpp). Counts missed refreshes. Runs all four
// lines concurrently, unless --one-by-one, --baud or --load select otherwise.
//
// usage: endurance_bench [--seconds N] [--map 11|12|13|14] [--one-by-one] [--baud N] [--load SHARE]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "tests/plan/maps.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {
namespace {

constexpr auto kAnswerTime = std::chrono::milliseconds(2);  // of the simulated devices
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
  const double stretch = test::least_load(map, line.baud, kAnswerTime) / line.load;
  std::string text =
      "  - name: " + line.name() + "\n    port: { serial: {dir}/" + line.name() +
      ", baud: " + std::to_string(line.baud) +
      ", format: 8E1 }\n    protocol: modbus-rtu\n    defaults: { silence: 3.5c }\n" +
      "    devices:\n";
  unsigned unit = 0;
  for (const test::MapRow& row : map) {  // sorted by unit
    if (row.unit != unit) {
      unit = row.unit;
      text += "      - name: unit-" + std::to_string(unit) +
              "\n        address: " + std::to_string(unit) + "\n        channels:\n";
    }
    const long long refresh = static_cast<long long>(row.refresh * stretch * 1e6);
    text += "          - { name: r" + std::to_string(row.address) +
            ", at: \"holding:" + std::to_string(row.address) +
            "\", type: uint16, refresh: " + std::to_string(refresh) + "us }\n";
    refreshes[line.name() + "/unit-" + std::to_string(unit) + "/r" + std::to_string(row.address)] =
        static_cast<double>(refresh) * 1e-6;
  }
  return text;
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
  for (const Line& line : lines) {
    if (!wait_for_path(plant.link(line.name()), 10))
      throw std::runtime_error("the simulator made no link");
  }
  plant.listen();
  plant.start_bridge();
  plant.wait_until_seen(refreshes.size(), 60);
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
        "of its refresh; "
        "planned %.3f, measured %.3f%s\n",
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
  try {
    const double seconds = seconds_from(argc, argv, 60);
    std::string number = "11";
    bool one_by_one = false;
    std::uint32_t baud = 0;
    double load = 0;
    for (int i = 1; i < argc; ++i) {
      if (std::strcmp(argv[i], "--map") == 0 && i + 1 < argc) number = argv[i + 1];
      if (std::strcmp(argv[i], "--baud") == 0 && i + 1 < argc)
        baud = static_cast<std::uint32_t>(std::atoi(argv[i + 1]));
      if (std::strcmp(argv[i], "--load") == 0 && i + 1 < argc) load = std::atof(argv[i + 1]);
      one_by_one = one_by_one || std::strcmp(argv[i], "--one-by-one") == 0;
    }
    fieldcast::test::Map map =
        fieldcast::test::read_map(std::string(FIELDCAST_MAPS) + "/map" + number + ".csv");
    std::ranges::stable_sort(map, {}, &fieldcast::test::MapRow::unit);
    std::vector<Line> lines{{19200, 0.5}, {115200, 0.5}, {19200, 0.6}, {115200, 0.6}};
    std::erase_if(lines, [&](const Line& line) {
      return (baud != 0 && line.baud != baud) || (load > 0 && std::abs(line.load - load) > 1e-6);
    });
    if (lines.empty())
      throw std::runtime_error("no such line: --baud is 19200 or 115200, --load 0.5 or 0.6");
    if (one_by_one) {
      for (const Line& line : lines) measure({line}, map, seconds);
    } else {
      measure(lines, map, seconds);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "endurance_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
