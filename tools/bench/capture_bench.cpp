// What captures cost the wire: four lines at full load (300 scattered registers each, 115200 baud,
// devices that answer after 2 ms), read by one bridge, with every bus captured to a file and
// without, in turns. The figure is the share: refreshes of each bus with the capture / without.
//
// usage: capture_bench [--seconds N]     of each turn; there are 2 * kTurns of them
#include <chrono>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

#include "tools/bench/figures.hpp"
#include "tools/bench/plant.hpp"

namespace fieldcast::bench {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kBuses = 4;
constexpr int kUnits = 3;
constexpr int kRegisters = 100;
constexpr int kTurns = 6;

std::string name_of_bus(int bus) { return "bus-" + std::to_string(bus); }

std::string captured_buses() {
  std::string text;
  for (int bus = 0; bus < kBuses; ++bus)
    text += "  - name: " + name_of_bus(bus) + "\n    port: { serial: {dir}/" + name_of_bus(bus) +
            ", baud: 115200, format: 8E1 }\n    protocol: modbus-rtu\n"
            "    defaults: { refresh: 1s, mode: intensive, silence: 3.5c }\n    devices:\n" +
            scattered_devices(kUnits, kRegisters, "      ", static_cast<unsigned>(42 + bus));
  return text;
}

// Samples a second of each bus.
std::map<std::string, double> rates(Plant& plant, double seconds) {
  plant.forget_samples();
  const auto start = Clock::now();
  let_run(seconds);
  const auto seen = plant.seen();
  const double wall = std::chrono::duration<double>(Clock::now() - start).count();
  std::map<std::string, double> found;
  for (const auto& [channel, what] : seen)
    found[channel.substr(0, channel.find('/'))] += static_cast<double>(what.samples) / wall;
  return found;
}

// One process for each bus, as users start them.
std::vector<std::unique_ptr<Process>> capture_all(const Plant& plant, int turn) {
  std::vector<std::unique_ptr<Process>> captures;
  std::vector<std::string> files;
  for (int bus = 0; bus < kBuses; ++bus) {
    const std::string name =
        plant.folder().path() + "/" + name_of_bus(bus) + "-" + std::to_string(turn);
    files.push_back(name + ".pcapng");
    captures.push_back(std::make_unique<Process>(
        "fieldcast", std::vector<std::string>{"capture", name_of_bus(bus), "--out", files.back()},
        name + ".log"));
  }
  for (const std::string& file : files) {
    if (!wait_for_path(file, 10)) throw std::runtime_error("no capture began: " + file);
  }
  let_run(0.2);
  return captures;
}

void run_captures(double seconds) {
  Plant plant(captured_buses());
  plant.start_simulator();
  for (int bus = 0; bus < kBuses; ++bus) {
    if (!wait_for_path(plant.link(name_of_bus(bus)), 10))
      throw std::runtime_error("the simulator made no link");
  }
  plant.listen();
  plant.start_bridge();
  plant.wait_until_seen(kBuses * kUnits * kRegisters, 30);
  let_run(2);
  std::map<std::string, double> without, with;
  const auto add = [&](std::map<std::string, double>& sums) {
    for (const auto& [bus, rate] : rates(plant, seconds)) sums[bus] += rate / kTurns;
  };
  // In turns and in both orders: whatever else this machine does falls on both.
  for (int turn = 0; turn < kTurns; ++turn) {
    if (turn % 2 == 0) add(without);
    {
      const auto captures = capture_all(plant, turn);
      add(with);
    }
    if (turn % 2 == 1) add(without);
  }
  double least = 1e9, all = 0;
  for (const auto& [bus, rate] : without) {
    const double share = with[bus] / rate;
    print_figure((bus + ", refreshes a second without a capture").c_str(), rate, "1/s", "");
    print_figure((bus + ", with / without").c_str(), share, "", "");
    least = std::min(least, share);
    all += share / kBuses;
  }
  print_figure("mean of with / without", all, "", "");
  print_figure("least of with / without", least, "", "goal >= 0.998");
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  try {
    fieldcast::bench::run_captures(fieldcast::bench::seconds_from(argc, argv, 10));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "capture_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
