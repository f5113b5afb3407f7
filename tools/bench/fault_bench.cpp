// Ten devices on one line. First one of them is dead, then half of its responses are noise.
// Measures the missed refreshes of the nine others.
//
// usage: fault_bench [--seconds N]
#include <cstdio>
#include <string>

#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {
namespace {

const char* kFaulty = "bus/unit-4";

std::string buses() {
  return serial_bus("bus", 19200, "refresh: 1s, mode: scheduled, timeout: 200ms, retries: 1",
                    scattered_devices(10, 12, 11));
}

void measure(const char* what, const std::string& faults, double seconds) {
  Plant plant(buses(), faults);
  plant.start_simulator();
  plant.listen();
  plant.start_bridge();
  plant.wait_until_seen(9 * 12, 20);
  let_run(8);  // until the first failures of the faulty device were reported
  const auto before = plant.devices();
  plant.forget_samples();
  let_run(seconds);
  const auto after = plant.devices();
  double missed = 0;
  for (const auto& [name, device] : after) {
    if (name != kFaulty)
      missed += static_cast<double>(device.report.deadline_misses -
                                    before.at(name).report.deadline_misses);
  }
  double longest = 0, refreshes = 0, bad = 0;
  for (const auto& [name, seen] : plant.seen()) {
    if (name.rfind(std::string(kFaulty) + '/', 0) == 0) continue;
    longest = std::max(longest, static_cast<double>(seen.longest_gap) / 1e9);
    refreshes += static_cast<double>(seen.samples);
    bad += static_cast<double>(seen.bad);
  }
  std::printf("%s\n", what);
  print_figure("  refreshes of the nine healthy devices", refreshes);
  print_figure("  refreshes that they missed", missed, "", "goal 0");
  print_figure("  bad samples of theirs", bad, "", "goal 0");
  print_figure("  longest gap between two samples of theirs", longest, "s", "promise 1");
  print_figure("  load measured", plant.buses().at("bus").report.measured_load);
  print_figure("  exchanges of the faulty device that failed",
               after.at(kFaulty).report.failures - before.at(kFaulty).report.failures);
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("fault_bench", argc, argv, [](const Arguments& arguments) {
    const double seconds = arguments.number("--seconds", 30.0);
    measure("all ten healthy", "", seconds);
    measure("unit-4 dead", "buses: { bus: { devices: { unit-4: { silence: always } } } }\n",
            seconds);
    measure("half of unit-4's responses are noise",
            "buses: { bus: { devices: { unit-4: { garble: 0.5 } } } }\n", seconds);
  });
}
