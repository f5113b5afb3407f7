// fieldcast-sim: simulates the plant of a configuration file at the ports that the bridge opens.
#include <fmt/format.h>
#include <sched.h>

#include <cstdio>
#include <string>

#include "bridge/base/write_faults.hpp"
#include "bridge/process/command_line.hpp"
#include "config/loader/loader.hpp"
#include "core/base/duration_text.hpp"
#include "core/base/json.hpp"
#include "tools/sim/bus/fault_file.hpp"
#include "tools/sim/plant_loop.hpp"

namespace {

using namespace fieldcast;

enum ExitCode : int { kFine = 0, kBadArguments = 2, kBadFile = 3, kNoPort = 4, kNoReport = 5 };

struct Arguments {
  std::string config, faults, report, time;
  std::uint64_t seed = 1;
  bool quiet = false, json = false, spin = false, realtime = false;
};

void describe(CommandLine& line, Arguments& given) {
  line.set_footer(
      "Ends with SIGINT or SIGTERM and removes its links. SIGUSR1 writes the report. The faults "
      "file: tools/sim/README.md.");
  line.text("CONFIG", given.config, "configuration of the bridge").required();
  line.text("--faults", given.faults, "what goes wrong in the plant (YAML)");
  line.number("--seed", given.seed, "of waveforms and faults; the same seed is the same plant")
      .show_default();
  line.text("--seconds,--for", given.time, "end by itself after this time (20, 500ms, 2min)");
  line.text("--report", given.report,
            "write counters of every device to this file at the end, as JSON");
  line.flag("--spin", given.spin,
            "busy-wait the last 100 us before each instant: exact to a few us, costs a core");
  line.flag("--realtime", given.realtime,
            "run before everything else on this machine (SCHED_RR; needs the right to)");
  line.flag("--quiet", given.quiet, "say nothing but errors");
  line.flag("--json", given.json, "say where the buses are as JSON lines");
}

void say(const Arguments& given, const std::vector<std::unique_ptr<sim::SimBus>>& buses,
         const std::vector<std::string>& locations) {
  if (given.quiet) return;
  for (std::size_t i = 0; i < buses.size(); ++i) {
    const BusSpec& spec = buses[i]->spec();
    if (given.json) {
      std::puts(sim::location_line(spec, locations[i]).c_str());
    } else {
      std::printf("%-16s %s, %zu device%s (%s)\n", spec.name.c_str(), locations[i].c_str(),
                  spec.devices.size(), spec.devices.size() == 1 ? "" : "s",
                  to_text(spec.port).c_str());
    }
  }
  std::puts(given.json ? Json{{"ready", true}}.text().c_str() : "READY");
  std::fflush(stdout);
}

int fail(ExitCode code, const std::string& text) {
  std::fprintf(stderr, "%s%s", text.c_str(), text.ends_with('\n') ? "" : "\n");
  return code;
}

tl::expected<Instant, std::string> end_of(const Arguments& given, Instant start) {
  if (given.time.empty()) return kNever;
  const auto time = read_duration(given.time, {Duration{}, std::chrono::hours{24 * 365}, true});
  if (!time) return tl::unexpected("--seconds: " + fault_text(given.time, time.error()));
  return *time == Duration{} ? kNever : start + *time;  // 0 means forever
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
      return fail(kBadFile,
                  fmt::format("{}: {}: modules that dial in are simulated in virtual time only",
                              given.config, spec.name));
    if (std::holds_alternative<Rfc2217PortSpec>(spec.port))
      return fail(kBadFile,
                  fmt::format("{}: {}: a server of RFC 2217 is not simulated; simulate its "
                              "line as a serial port, and serve that with ser2net",
                              given.config, spec.name));
    if (has_tls(spec.port))
      return fail(kBadFile, fmt::format("{}: {}: the simulator has no TLS; use a port 'tcp'",
                                        given.config, spec.name));
    auto bus = sim::SimBus::make(spec, faults.buses[spec.name], given.seed, start);
    if (!bus) return fail(kBadFile, fmt::format("{}: {}", given.config, bus.error()));
    buses.push_back(std::move(*bus));
  }
  sim::LoopOptions options;
  const auto end = end_of(given, start);
  if (!end) return fail(kBadArguments, end.error());
  options.end = *end;
  if (given.spin) options.spin = std::chrono::microseconds{100};
  options.report = given.report;
  const sched_param lowest{1};
  if (given.realtime && ::sched_setscheduler(0, SCHED_RR, &lowest) != 0) {
    return fail(kBadArguments,
                "--realtime: not permitted; give the right with 'ulimit -r 1' or CAP_SYS_NICE");
  }
  sim::PlantLoop loop(buses, options);
  if (const auto opened = loop.open(); !opened) return fail(kNoPort, opened.error());
  say(given, buses, loop.locations());
  return loop.run() ? kFine : fail(kNoReport, given.report + ": cannot write the report");
}

}  // namespace

int main(int argc, char** argv) {
  make_writes_fail_not_kill();
  Arguments given;
  CommandLine line("fieldcast-sim",
                   "Simulates the plant of a configuration: a pseudo-terminal at each serial path, "
                   "a listener for each bus of TCP or UDP.");
  describe(line, given);
  if (const auto fault = line.parse_or_print(argc, argv)) return *fault ? kBadArguments : kFine;
  return simulate(given);
}
