#include "tests/plan/maps.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <set>
#include <stdexcept>

namespace fieldcast::test {

Map read_map(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot open " + path);
  Map map;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    MapRow row;
    if (std::sscanf(line.c_str(), "%u,%u,%lf", &row.unit, &row.address, &row.refresh) != 3)
      throw std::runtime_error(path + ": " + line);
    map.push_back(row);
  }
  return map;
}

Map random_map(std::uint64_t seed, std::size_t channels, unsigned units) {
  constexpr std::array kRefreshes{0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0};
  std::mt19937_64 random(seed);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  Map map;
  for (unsigned unit = 1; unit <= units; ++unit) {
    std::uint32_t address = below(30);
    const std::size_t share = channels / units + (unit <= channels % units ? 1 : 0);
    for (std::size_t i = 0; i < share; ++i) {
      map.push_back({unit, address, kRefreshes[below(kRefreshes.size())]});
      const bool far = below(6) == 0;
      address += far ? 12 + below(60) : 1 + below(4);
    }
  }
  return map;
}

ScheduleInput input_of(const Map& map, const Protocol& protocol, std::uint32_t baud, Duration delay,
                       double stretch) {
  ScheduleInput input;
  input.line = LineFormat{baud, 8, Parity::kEven, 1};
  input.silence = input.line.characters(3.5);
  unsigned units = 0;
  for (const MapRow& row : map) units = std::max(units, row.unit);
  DeviceTiming device;
  device.protocol = &protocol;
  device.response_time = input.line.characters(3.5) + delay;
  input.devices.assign(units, device);
  for (const MapRow& row : map) {
    Point point;
    point.device = static_cast<DeviceIndex>(row.unit - 1);
    point.range = Range{kRegisters, row.address, 1};
    point.refresh = from_seconds(row.refresh * stretch);
    input.points.push_back(point);
  }
  return input;
}

std::string configuration_of(const Map& map, double stretch, std::uint32_t baud,
                             const Notation& notation) {
  std::string text = "bridge: b\nbuses:\n  - name: line\n    port: { serial: /dev/none, baud: " +
                     std::to_string(baud) + ", format: 8E1 }\n    protocol: " + notation.protocol +
                     "\n    defaults: { silence: 3.5c }\n    devices:\n";
  unsigned units = 0;
  for (const MapRow& row : map) units = std::max(units, row.unit);
  for (unsigned unit = 1; unit <= units; ++unit) {
    text += "      - name: u" + std::to_string(unit) +
            "\n        address: " + std::to_string(unit) + "\n        channels:\n";
    for (const MapRow& row : map) {
      if (row.unit != unit) continue;
      text += "          - { name: r" + std::to_string(row.address) + ", at: \"" + notation.area +
              std::to_string(row.address * notation.step) + "\", type: uint16, refresh: " +
              std::to_string(static_cast<long>(row.refresh * stretch * 1e6)) + "us }\n";
    }
  }
  return text;
}

double least_load(const Map& map, std::uint32_t baud, Duration delay) {
  const double character = 11.0 / baud;
  const double request = 20 * character + to_seconds(delay), item = 2 * character;
  std::map<unsigned, std::vector<MapRow>> units;
  for (const MapRow& row : map) units[row.unit].push_back(row);
  double load = 0;
  for (auto& [unit, rows] : units) {
    std::sort(rows.begin(), rows.end(),
              [](const MapRow& a, const MapRow& b) { return a.address < b.address; });
    double fastest = rows.front().refresh;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (i > 0 && (rows[i].address - rows[i - 1].address - 1) * item >= request) {
        load += request / fastest;
        fastest = rows[i].refresh;
      }
      fastest = std::min(fastest, rows[i].refresh);
      load += item / rows[i].refresh;
    }
    load += request / fastest;
  }
  return load;
}

double proven_load(const Map& map, std::uint32_t baud, Duration delay) {
  const double character = 11.0 / baud;
  const double request = 20 * character + to_seconds(delay), item = 2 * character;
  std::map<unsigned, std::map<double, std::vector<std::uint32_t>>>
      units;  // units; in each: refresh; in each: addresses
  for (const MapRow& row : map) units[row.unit][row.refresh].push_back(row.address);
  double load = 0;
  for (const auto& [unit, classes] : units) {
    std::set<std::uint32_t> wanted;
    double before = 0;
    for (const auto& [refresh, addresses] : classes) {
      wanted.insert(addresses.begin(), addresses.end());
      double cost = request;
      for (auto at = wanted.begin(); at != wanted.end(); ++at) {
        cost += item;
        if (at != wanted.begin()) cost += std::min(request, item * (*at - *std::prev(at) - 1));
      }
      load += (cost - before) / refresh;
      before = cost;
    }
  }
  return load;
}

}  // namespace fieldcast::test
