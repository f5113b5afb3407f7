// 1 000 Modbus TCP devices and four saturated serial buses at 19200 baud in one bridge. Prints the
// processor time and the memory of the bridge, the missed refreshes of the TCP devices, and the
// share of their wires that the serial buses keep, compared with a bridge without TCP devices.
//
// usage: devices_bench [--seconds N] [--devices N]
#include <string>

#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {
namespace {

constexpr int kSerialBuses = 4, kUnits = 4;  // units of a TCP connection

std::string serial_buses() {
  std::string text;
  for (int b = 1; b <= kSerialBuses; ++b)
    text += serial_bus("serial-" + std::to_string(b), 19200, "refresh: 2s, mode: intensive",
                       scattered_devices(2, 150, 7));
  return text;
}

// One channel of each device. A light bus reads earlier than asked for: ten times a second.
std::string tcp_buses(int devices) {
  std::string text;
  for (int b = 1; b <= devices / kUnits; ++b) {
    text += "  - name: tcp-" + std::to_string(b) +
            "\n    port: { tcp: \"127.0.0.1:" + std::to_string(free_port()) +
            "\" }\n    protocol: modbus-tcp\n    defaults: { refresh: 125ms }\n    devices:\n" +
            packed_devices(kUnits, 1, 1);
  }
  return text;
}

struct Sum {
  double samples = 0, missed = 0, share = 0;
  int buses = 0;
};

Sum sum_of(Plant& plant, const std::string& prefix) {
  Sum sum;
  for (const auto& [name, bus] : plant.buses()) {
    if (!name.starts_with(prefix)) continue;
    sum.samples += static_cast<double>(bus.report.samples);
    sum.missed += static_cast<double>(bus.report.deadline_misses);
    sum.share += bus.report.measured_load;
    ++sum.buses;
  }
  return sum;
}

// Returns the mean share of the serial wires.
double measure(int devices, double seconds) {
  Plant plant(serial_buses() + tcp_buses(devices));
  plant.start_simulator();
  plant.start_bridge();
  plant.listen_to_status();
  let_run(15);  // the measured load covers the last ten seconds
  const Sum before = sum_of(plant, "tcp-");
  const double cpu = plant.bridge().cpu_seconds();
  let_run(seconds);
  const Sum after = sum_of(plant, "tcp-");
  const Sum serial = sum_of(plant, "serial-");
  const double share = serial.share / serial.buses;
  std::printf("%d TCP devices\n", after.buses * kUnits);
  print_figure("  samples of TCP devices a second", (after.samples - before.samples) / seconds,
               "1/s");
  print_figure("  their missed refreshes", after.missed - before.missed, "", "goal 0");
  print_figure("  processor of the bridge", (plant.bridge().cpu_seconds() - cpu) / seconds, "cores",
               "goal < 1");
  print_figure("  resident memory of the bridge", plant.bridge().resident_mb(), "MB", "goal < 300");
  print_figure("  share of the serial wires, mean", share);
  return share;
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("devices_bench", argc, argv, [](const Arguments& arguments) {
    const double seconds = arguments.number("--seconds", 20.0);
    const double without = measure(0, seconds);
    const double with = measure(arguments.number("--devices", 1000), seconds);
    print_figure("share of the serial wires, with / without TCP devices", with / without, "",
                 "goal >= 0.98");
  });
}
