// fieldcast-sim: the plant of a configuration file, simulated where the bridge looks for it.
#include <sched.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "config/loader.hpp"
#include "tools/sim/fault_file.hpp"
#include "tools/sim/plant_loop.hpp"

namespace {

using namespace fieldcast;

// What the caller of the program can tell apart.
enum ExitCode : int { kFine = 0, kBadArguments = 2, kBadFile = 3, kNoPort = 4, kNoReport = 5 };

struct Arguments {
  std::string config, faults, report;
  std::uint64_t seed = 1;
  double seconds = 0;
  bool quiet = false, json = false, spin = false, realtime = false;
};

void describe(CLI::App& app, Arguments& given) {
  app.description("Simulates the plant of a configuration: a pseudo-terminal at each serial path, a listener for each TCP bus.");
  app.footer(
      "Ends with SIGINT or SIGTERM and removes its links. SIGUSR1 writes the report. The faults file: tools/sim/README.md.");
  app.add_option("CONFIG", given.config, "configuration of the bridge")->required();
  app.add_option("--faults", given.faults, "what goes wrong in the plant (YAML)");
  app.add_option("--seed", given.seed, "of waveforms and faults; the same seed is the same plant")->capture_default_str();
  app.add_option("--seconds", given.seconds, "end by itself after this time")->check(CLI::Range(0.0, 1e9));
  app.add_option("--report", given.report, "write counters of every device to this file at the end, as JSON");
  app.add_flag("--spin", given.spin, "busy-wait the last 100 us before each instant: exact to a few us, costs a core");
  app.add_flag("--realtime", given.realtime, "run before everything else on this machine (SCHED_RR; needs the right to)");
  app.add_flag("--quiet", given.quiet, "say nothing but errors");
  app.add_flag("--json", given.json, "say where the buses are as JSON lines");
}

void say(const Arguments& given, const std::vector<std::unique_ptr<sim::SimBus>>& buses, const std::vector<std::string>& places) {
  if (given.quiet) return;
  for (std::size_t i = 0; i < buses.size(); ++i) {
    const BusSpec& spec = buses[i]->spec();
    if (given.json) {
      const nlohmann::ordered_json line{
          {"bus", spec.name}, {"place", places[i]}, {"port", to_text(spec.port)}, {"devices", spec.devices.size()}};
      std::printf("%s\n", line.dump().c_str());
    } else {
      std::printf("%-16s %s, %zu device%s (%s)\n", spec.name.c_str(), places[i].c_str(), spec.devices.size(),
                  spec.devices.size() == 1 ? "" : "s", to_text(spec.port).c_str());
    }
  }
  std::puts(given.json ? "{\"ready\":true}" : "READY");
  std::fflush(stdout);
}

int fail(ExitCode code, const std::string& text) {
  std::fprintf(stderr, "%s%s", text.c_str(), text.ends_with('\n') ? "" : "\n");
  return code;
}

int simulate(const Arguments& given) {
  const auto plant = config::load_file(given.config);
  if (!plant) return fail(kBadFile, config::to_text(plant.error()));
  sim::Faults faults;
  if (!given.faults.empty()) {
    auto loaded = sim::load_faults(given.faults, *plant);
    if (!loaded) return fail(kBadFile, config::to_text(loaded.error()));
    faults = std::move(*loaded);
  }
  const Instant start = sim::now();
  std::vector<std::unique_ptr<sim::SimBus>> buses;
  for (const BusSpec& spec : plant->buses) {
    if (std::holds_alternative<DialInPortSpec>(spec.port))
      return fail(kBadFile, given.config + ": " + spec.name + ": modules that dial in are simulated in virtual time only");
    auto bus = sim::SimBus::make(spec, faults.buses[spec.name], given.seed, start);
    if (!bus) return fail(kBadFile, given.config + ": " + bus.error());
    buses.push_back(std::move(*bus));
  }
  sim::LoopOptions options;
  if (given.seconds > 0) options.end = start + from_seconds(given.seconds);
  if (given.spin) options.spin = std::chrono::microseconds{100};
  options.report = given.report;
  const sched_param lowest{1};
  if (given.realtime && ::sched_setscheduler(0, SCHED_RR, &lowest) != 0) {
    return fail(kBadArguments, "--realtime: not permitted; give the right with 'ulimit -r 1' or CAP_SYS_NICE");
  }
  sim::PlantLoop loop(buses, options);
  if (const auto opened = loop.open(); !opened) return fail(kNoPort, opened.error());
  say(given, buses, loop.places());
  return loop.run() ? kFine : fail(kNoReport, given.report + ": cannot write the report");
}

}  // namespace

int main(int argc, char** argv) {
  Arguments given;
  CLI::App app;
  describe(app, given);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) { return app.exit(error) == 0 ? kFine : kBadArguments; }
  return simulate(given);
}
