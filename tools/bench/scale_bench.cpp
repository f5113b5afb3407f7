// Saturated buses at 19200 baud with many channels, one bridge, stations in other processes.
// Measures the samples received (by sequence), the cost, and the wire share of every bus. Then
// measures a bare Fast DDS writer and reader with the same data, so that the ratio is independent
// of the machine's load.
//
// usage: scale_bench [--seconds N] [--buses N] [--channels N] [--one-by-one] [--loss SHARE]
//                    [--bridge PROGRAM] [--run N] [--scrape ROUNDS]
//
// Default of --buses: 1, 16 and 32. --one-by-one: stations use fieldcast/Sample. --bridge: bridge
// of a different build, to compare. --run: contiguous registers, N for each request, instead of
// scattered ones (blocks of about 10). --scrape: measures only each bus's wire share with and
// without reading the metrics every second, alternately, in this many rounds.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/bench/plant/bare.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"
#include "tools/bench/support/stations.hpp"

namespace fieldcast::bench {
namespace {

struct Options {
  double seconds;
  int channels;  // of each bus
  int run;       // 0: scattered
  bool one_by_one;
  int scrape;   // rounds; 0: off
  double loss;  // share of the datagrams that do not reach a station
  std::string bridge;
};

std::string buses(int count, const Options& options) {
  constexpr int kDevices = 2;
  const int registers = options.channels / kDevices;
  std::string text;
  for (int b = 1; b <= count; ++b) {
    text += serial_bus("bus-" + std::to_string(b), 19200, "refresh: 2s, mode: intensive",
                       options.run == 0 ? scattered_devices(kDevices, registers, 7)
                                        : packed_devices(kDevices, registers, options.run));
  }
  return text;
}

struct Done {
  double samples = 0, exchanges = 0;
};
Done done(const std::map<std::string, StationBusStatus>& buses) {
  Done sum;
  for (const auto& [name, bus] : buses) {
    sum.samples += static_cast<double>(bus.report.samples);
    sum.exchanges += static_cast<double>(bus.report.exchanges);
  }
  return sum;
}

struct Figures {
  double samples = 0, exchanges = 0;  // a second
  double bridge = 0, station = 0;     // processor seconds for 1 000 samples; of the first station
};

class Measurement {
 public:
  explicit Measurement(const Options& options, Plant& plant) : options_(options), plant_(plant) {}

  // The stations already run; stopped ones are not counted.
  Figures run(const char* what, const std::vector<StationProcess*>& stations) {
    const double cpu = plant_.bridge().cpu_seconds();
    const auto before = plant_.buses();
    const std::uint64_t drops = dropped_datagrams();
    std::vector<double> station_cpu;
    std::vector<Received> received;
    std::vector<std::uint64_t> station_drops;
    for (const StationProcess* station : stations) {
      station_drops.push_back(dropped_datagrams(station->id()));
      station_cpu.push_back(station->cpu_seconds());
      received.push_back(station->received());
    }
    let_run(options_.seconds);
    const double spent = plant_.bridge().cpu_seconds() - cpu;
    const auto after = plant_.buses();
    const double samples = done(after).samples - done(before).samples;
    Figures figures{samples / options_.seconds,
                    (done(after).exchanges - done(before).exchanges) / options_.seconds,
                    1000 * spent / samples, 0};
    std::printf("%s\n", what);
    print_figure("  samples published a second", samples / options_.seconds, "1/s");
    print_figure("  processor of the bridge", spent / options_.seconds, "cores");
    print_figure("  processor time of the bridge for 1 000 samples", figures.bridge, "s");
    print_figure("  resident memory of the bridge", plant_.bridge().resident_mb(), "MB");
    print_shares(after);
    for (std::size_t i = 0; i < stations.size(); ++i) {
      const Received now = stations[i]->received();
      const auto got = static_cast<double>(now.samples - received[i].samples);
      const auto missing = static_cast<double>(now.missing - received[i].missing);
      const double station = stations[i]->cpu_seconds() - station_cpu[i];
      print_figure("  received, of what was published (by sequence)", got / (got + missing), "",
                   "goal >= 0.995");
      print_figure("  received, of what the bridge counted", got / samples);
      print_figure("  processor time of the station for 1 000 samples", 1000 * station / got, "s");
      print_figure("  datagrams dropped at its sockets",
                   dropped_datagrams(stations[i]->id()) - station_drops[i]);
      if (i == 0) figures.station = 1000 * station / got;
    }
    print_figure("  datagrams dropped on this machine", dropped_datagrams() - drops);
    return figures;
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
    print_figure("  share of its wire, least bus", lowest);
    print_figure("  share of its wire, mean, of that without stations", mean / alone_, "",
                 "goal >= 0.995");
  }

  const Options& options_;
  Plant& plant_;
  double alone_ = 0;  // the mean share of the first run
};

struct Compared {
  Figures alone, one_station;
};

Compared measure_plant(const Options& options, int count) {
  Plant plant(buses(count, options));
  plant.start_simulator();
  plant.start_bridge(options.bridge);
  plant.listen_to_status();
  let_run(12);  // the measured load covers the last ten seconds
  Measurement measurement(options, plant);
  Compared compared;
  compared.alone = measurement.run("nobody listens to samples", {});
  std::vector<std::unique_ptr<StationProcess>> stations;
  std::vector<StationProcess*> running;
  const auto add = [&] {
    stations.push_back(std::make_unique<StationProcess>(
        plant.folder(), plant.domain(), "station-" + std::to_string(stations.size()),
        options.one_by_one ? "one-by-one" : "by-blocks", options.loss));
    running.push_back(stations.back().get());
  };
  add();
  let_run(11);
  compared.one_station = measurement.run("one station", running);
  while (stations.size() < 4) add();
  let_run(11);
  measurement.run("four stations", running);
  kill(stations.front()->id(), SIGSTOP);
  running.erase(running.begin());
  let_run(6);
  measurement.run("four stations, one of them stopped", running);
  kill(stations.front()->id(), SIGCONT);
  return compared;
}

// The same samples a second, in blocks of the same mean size.
void compare_with_bare(const Options& options, std::size_t channels, const Compared& plant) {
  const ScratchFolder folder;
  const Figures& bridge = plant.one_station;
  BareLoad load{channels, 1, bridge.exchanges};
  load.rows = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::lround(bridge.samples / bridge.exchanges)));
  for (const BareData data : {BareData::kBlocks, BareData::kSamples}) {
    const BarePair pair(folder, own_domain(), data, load);
    let_run(2);
    const BarePair::Spent before = pair.spent();
    const std::uint64_t drops = dropped_datagrams();
    let_run(options.seconds);
    const BarePair::Spent after = pair.spent();
    const auto written = static_cast<double>(after.written - before.written);
    const auto received = static_cast<double>(after.received - before.received);
    const double writer = 1000 * (after.writer - before.writer) / written;
    const double reader = 1000 * (after.reader - before.reader) / received;
    std::printf("bare writer and reader, %s of %zu channels\n",
                data == BareData::kBlocks ? "messages" : "keyed samples, bursts", load.rows);
    print_figure("  samples written a second", written / options.seconds, "1/s");
    print_figure("  received, of what was written", received / written);
    print_figure("  processor time of the writer for 1 000 samples", writer, "s");
    print_figure("  processor time of the reader for 1 000 samples", reader, "s");
    print_figure("  the bridge's, of the bare writer's", bridge.bridge / writer);
    print_figure("  what one station adds to it, of the bare writer's",
                 (bridge.bridge - plant.alone.bridge) / writer);
    print_figure("  the station's, of the bare reader's", bridge.station / reader);
    print_figure("  datagrams dropped on this machine", dropped_datagrams() - drops);
  }
}

struct Shares {
  double without = 0, with = 0;
};

void print_scrapes(const std::map<std::string, Shares>& shares, int rounds, const Scraper& last) {
  Shares sum;
  double least = 1e9, most = 0;
  for (const auto& [name, bus] : shares) {
    sum.without += bus.without;
    sum.with += bus.with;
    least = std::min(least, bus.with / bus.without);
    most = std::max(most, bus.with / bus.without);
  }
  const double all = rounds * static_cast<double>(shares.size());
  print_figure("  share of its wire, mean, no scrapes", sum.without / all);
  print_figure("  share of its wire, mean, a scrape each second", sum.with / all);
  print_figure("  with scrapes / without, mean", sum.with / sum.without, "", "goal >= 0.998");
  print_figure("  with scrapes / without, least bus", least, "", "goal >= 0.998");
  print_figure("  with scrapes / without, most", most);
  print_figure("  scrapes served in the last round", last.scrapes());
  print_figure("  bytes of one", last.bytes(), "B");
}

void measure_scrapes(const Options& options, int count) {
  constexpr double kWindow = 10.5;  // the measured load covers the last ten seconds
  const std::uint16_t port = free_port();
  Plant plant(buses(count, options), {},
              "metrics: { listen: 127.0.0.1:" + std::to_string(port) + " }\n");
  plant.start_simulator();
  plant.start_bridge(options.bridge);
  plant.listen_to_status();
  let_run(3);
  std::map<std::string, Shares> shares;
  for (int round = 1; round <= options.scrape; ++round) {
    let_run(kWindow);
    for (const auto& [name, bus] : plant.buses()) shares[name].without += bus.report.measured_load;
    const Scraper scraper(port);
    let_run(kWindow);
    for (const auto& [name, bus] : plant.buses()) shares[name].with += bus.report.measured_load;
    if (round == options.scrape) print_scrapes(shares, options.scrape, scraper);
  }
}

void measure(const Options& options, int count) {
  std::printf("== %d buses of %d channels\n", count, options.channels);
  if (options.scrape > 0) return measure_scrapes(options, count);
  const auto channels =
      static_cast<std::size_t>(count) * static_cast<std::size_t>(options.channels);
  compare_with_bare(options, channels, measure_plant(options, count));
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("scale_bench", argc, argv, [](const Arguments& arguments) {
    const Options options{.seconds = arguments.number("--seconds", 10.0),
                          .channels = arguments.number("--channels", 300),
                          .run = arguments.number("--run", 0),
                          .one_by_one = arguments.has("--one-by-one"),
                          .scrape = arguments.number("--scrape", 0),
                          .loss = arguments.number("--loss", 0.0),
                          .bridge = arguments.text("--bridge", "fieldcast-bridge")};
    const int buses = arguments.number("--buses", 0);
    for (const int count : buses > 0 ? std::vector{buses} : std::vector{1, 16, 32})
      measure(options, count);
  });
}
