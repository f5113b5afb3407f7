// Measures the cost of captures: one bridge reads 16 saturated lines (300 scattered registers each,
// 19200 baud, devices with a response time of 2 ms), alternately with every bus captured to a file
// and without. The figure is the ratio with / without of each bus's wire share.
//
// usage: capture_bench [TURNS]     of 21 s each (4)
#include <memory>
#include <stdexcept>
#include <string>

#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {
namespace {

constexpr int kBuses = 16;
constexpr int kUnits = 3;
constexpr int kRegisters = 100;

std::string name_of_bus(int bus) { return "bus-" + std::to_string(bus); }

std::string captured_buses() {
  std::string text;
  for (int bus = 0; bus < kBuses; ++bus)
    text += serial_bus(name_of_bus(bus), 19200, "refresh: 1s, mode: intensive, silence: 3.5c",
                       scattered_devices(kUnits, kRegisters, static_cast<unsigned>(42 + bus)));
  return text;
}

using Shares = std::map<std::string, double>;
void add_shares(Plant& plant, Shares& sums) {
  let_run(10.5);  // the measured load covers the last ten seconds
  for (const auto& [name, bus] : plant.buses()) sums[name] += bus.report.measured_load;
}

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

void run_captures(int turns) {
  Plant plant(captured_buses());
  plant.start_simulator();
  plant.listen();
  plant.start_bridge();
  plant.wait_until_seen(kBuses * kUnits * kRegisters, 30);
  let_run(2);
  Shares without, with;
  // In both orders, so that other load affects both alike.
  for (int turn = 0; turn < turns; ++turn) {
    if (turn % 2 == 0) add_shares(plant, without);
    {
      const auto captures = capture_all(plant, turn);
      add_shares(plant, with);
    }
    if (turn % 2 == 1) add_shares(plant, without);
  }
  const double all = turns * kBuses;
  double least = 1e9, plain = 0, captured = 0;
  for (const auto& [bus, share] : without) {
    least = std::min(least, with[bus] / share);
    plain += share / all;
    captured += with[bus] / all;
  }
  print_figure("share of its wire, mean, no capture", plain);
  print_figure("share of its wire, mean, every bus captured", captured);
  print_figure("with / without, mean", captured / plain, "", "goal >= 0.998");
  print_figure("with / without, least bus", least, "", "goal >= 0.998");
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("capture_bench", argc, argv,
                   [](const Arguments& arguments) { run_captures(arguments.number_at(0, 4)); });
}
