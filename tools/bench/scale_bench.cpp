// Saturated buses at 19200 baud with many channels, one bridge, stations in other processes: what
// the stations received (by sequence), what that costs, and whether every bus gets its share of its
// wire.
//
// usage: scale_bench [--seconds N] [--buses N] [--channels N] [--one-by-one] [--loss SHARE]
//                    [--bridge PROGRAM]
//
// Without --buses: 1, 16 and 32 of them. --one-by-one: stations take fieldcast/Sample. --bridge: a
// bridge of another build, to compare.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/bench/figures.hpp"
#include "tools/bench/plant.hpp"
#include "tools/bench/stations.hpp"

namespace fieldcast::bench {
namespace {

struct Options {
  double seconds = 10;
  std::vector<int> buses = {1, 16, 32};
  int channels = 300;  // of each bus
  bool one_by_one = false;
  double loss = 0;  // share of the datagrams that do not reach a station
  std::string bridge = "fieldcast-bridge";
};

Options options_from(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const char* const value = i + 1 < argc ? argv[i + 1] : "";
    if (word == "--seconds") options.seconds = std::atof(value);
    if (word == "--buses") options.buses = {std::atoi(value)};
    if (word == "--channels") options.channels = std::atoi(value);
    if (word == "--one-by-one") options.one_by_one = true;
    if (word == "--loss") options.loss = std::atof(value);
    if (word == "--bridge") options.bridge = value;
  }
  return options;
}

std::string buses(int count, int channels) {
  constexpr int kDevices = 2;
  std::string text;
  for (int b = 1; b <= count; ++b) {
    const std::string name = "bus-" + std::to_string(b);
    text += "  - name: " + name + "\n    port: { serial: {dir}/" + name +
            ", baud: 19200, format: 8E1 }\n    protocol: modbus-rtu\n" +
            "    defaults: { refresh: 2s, mode: intensive }\n    devices:\n" +
            scattered_devices(kDevices, channels / kDevices, "      ", 7);
  }
  return text;
}

// Samples that the bridge says it published, over all buses.
std::uint64_t published(const std::map<std::string, StationBusStatus>& buses) {
  std::uint64_t sum = 0;
  for (const auto& [name, bus] : buses) sum += bus.report.samples;
  return sum;
}

class Measurement {
 public:
  explicit Measurement(const Options& options, Plant& plant) : options_(options), plant_(plant) {}

  // The stations run already; those that are stopped do not count.
  void run(const char* what, const std::vector<StationProcess*>& stations) {
    const double cpu = plant_.bridge().cpu_seconds();
    const auto before = plant_.buses();
    const std::uint64_t drops = dropped_datagrams();
    std::vector<double> station_cpu;
    std::vector<Received> received;
    for (const StationProcess* station : stations) {
      station_cpu.push_back(station->cpu_seconds());
      received.push_back(station->received());
    }
    let_run(options_.seconds);
    const double spent = plant_.bridge().cpu_seconds() - cpu;
    const auto after = plant_.buses();
    const auto samples = static_cast<double>(published(after) - published(before));
    std::printf("%s\n", what);
    print_figure("  samples published a second", samples / options_.seconds, "1/s", "");
    print_figure("  processor of the bridge", spent / options_.seconds, "cores", "");
    print_figure("  processor time of the bridge for 1 000 samples", 1000 * spent / samples, "s",
                 "");
    print_figure("  resident memory of the bridge", plant_.bridge().resident_mb(), "MB", "");
    print_shares(after);
    for (std::size_t i = 0; i < stations.size(); ++i) {
      const Received now = stations[i]->received();
      const auto got = static_cast<double>(now.samples - received[i].samples);
      const auto missing = static_cast<double>(now.missing - received[i].missing);
      const double station = stations[i]->cpu_seconds() - station_cpu[i];
      print_figure("  received, of what was published (by sequence)", got / (got + missing), "",
                   "goal >= 0.995");
      print_figure("  received, of what the bridge counted", got / samples, "", "");
      print_figure("  processor time of the station for 1 000 samples", 1000 * station / got, "s",
                   "");
    }
    print_figure("  datagrams dropped on this machine",
                 static_cast<double>(dropped_datagrams() - drops), "", "");
  }

 private:
  void print_shares(const std::map<std::string, StationBusStatus>& after) {
    double lowest = 1, sum = 0;
    for (const auto& [name, bus] : after) {
      lowest = std::min(lowest, bus.report.measured_load);
      sum += bus.report.measured_load;
    }
    const double mean = sum / static_cast<double>(after.size());
    if (alone_ == 0) alone_ = mean;
    print_figure("  share of its wire, least bus", lowest, "", "");
    print_figure("  share of its wire, mean, of that without stations", mean / alone_, "",
                 "goal >= 0.995");
  }

  const Options& options_;
  Plant& plant_;
  double alone_ = 0;  // the mean share of the first run
};

void measure(const Options& options, int count) {
  std::printf("== %d buses of %d channels\n", count, options.channels);
  Plant plant(buses(count, options.channels));
  plant.start_simulator();
  if (!wait_for_path(plant.link("bus-" + std::to_string(count)), 10))
    throw std::runtime_error("the simulator made no links");
  plant.start_bridge(options.bridge);
  plant.listen_to_status();
  let_run(12);  // the measured load looks back ten seconds
  Measurement measurement(options, plant);
  measurement.run("nobody listens to samples", {});
  std::vector<std::unique_ptr<StationProcess>> stations;
  std::vector<StationProcess*> running;
  const auto add = [&] {
    stations.push_back(std::make_unique<StationProcess>(
        plant.folder(), plant.domain(), "station-" + std::to_string(stations.size()),
        options.one_by_one, options.loss));
    running.push_back(stations.back().get());
  };
  add();
  let_run(11);
  measurement.run("one station", running);
  while (stations.size() < 4) add();
  let_run(11);
  measurement.run("four stations", running);
  kill(stations.front()->id(), SIGSTOP);
  running.erase(running.begin());
  let_run(6);
  measurement.run("four stations, one of them stopped", running);
  kill(stations.front()->id(), SIGCONT);
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  try {
    const Options options = options_from(argc, argv);
    for (const int count : options.buses) measure(options, count);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "scale_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
