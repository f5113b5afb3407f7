// 32 buses at 19200 baud, all saturated, one bridge: processor time, memory, and whether every bus
// gets its share of its wire.
//
// usage: scale_bench [--seconds N]
#include <cstdio>
#include <exception>
#include <map>
#include <string>

#include "tools/bench/figures.hpp"
#include "tools/bench/plant.hpp"

namespace fieldcast::bench {
namespace {

constexpr int kBuses = 32;
constexpr int kDevices = 2;
constexpr int kRegisters = 40;

std::string buses() {
  std::string text;
  for (int b = 1; b <= kBuses; ++b) {
    const std::string name = "bus-" + std::to_string(b);
    text += "  - name: " + name + "\n    port: { serial: {dir}/" + name +
            ", baud: 19200, format: 8E1 }\n    protocol: modbus-rtu\n" +
            "    defaults: { refresh: 2s, mode: intensive }\n    devices:\n" +
            scattered_devices(kDevices, kRegisters, "      ", 7);
  }
  return text;
}

// Samples that the bridge says it published, over all buses.
std::uint64_t published(const std::map<std::string, StationBusStatus>& buses) {
  std::uint64_t sum = 0;
  for (const auto& [name, bus] : buses) sum += bus.report.samples;
  return sum;
}

void measure(const char* what, Plant& plant, double seconds) {
  const double cpu = plant.bridge().cpu_seconds();
  const auto before = plant.buses();
  let_run(seconds);
  const double spent = plant.bridge().cpu_seconds() - cpu;
  const auto after = plant.buses();
  double lowest = 1;
  double highest = 0;
  for (const auto& [name, bus] : after) {
    lowest = std::min(lowest, bus.report.measured_load);
    highest = std::max(highest, bus.report.measured_load);
  }
  const auto samples = static_cast<double>(published(after) - published(before));
  std::printf("%s\n", what);
  print_figure("  samples a second", samples / seconds, "1/s", "");
  print_figure("  processor of the bridge", spent / seconds, "cores", "goal < 0.5");
  print_figure("  processor time for 1 000 samples", 1000 * spent / samples, "s", "peer 0.012");
  print_figure("  resident memory", plant.bridge().resident_mb(), "MB", "goal < 100");
  print_figure("  share of its wire, least bus", lowest, "", "the same on every bus");
  print_figure("  share of its wire, most bus", highest, "", "");
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  try {
    const double seconds = seconds_from(argc, argv, 20);
    Plant plant(buses());
    plant.start_simulator();
    if (!wait_for_path(plant.link("bus-32"), 10))
      throw std::runtime_error("the simulator made no links");
    plant.start_bridge();
    plant.listen_to_status();
    let_run(12);  // the measured load looks back ten seconds
    measure("nobody listens to samples", plant, seconds);
    plant.listen();
    plant.wait_until_seen(kBuses * kDevices * kRegisters, 20);
    measure("one station in another process listens to every sample", plant, seconds);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "scale_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
