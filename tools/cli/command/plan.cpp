#include "tools/cli/command/plan.hpp"

#include <chrono>
#include <iomanip>
#include <optional>
#include <ostream>
#include <utility>

#include "config/loader/loader.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/doctor/findings.hpp"
#include "tools/cli/doctor/gather.hpp"
#include "tools/cli/model/bus_plan.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/check_view.hpp"
#include "tools/cli/view/plan_view.hpp"
#include "tools/cli/view/simulation_view.hpp"
#include "tools/progress/progress_line.hpp"
#include "tools/sim/bus/fault_file.hpp"

namespace fieldcast::cli {

ExitCode doctor(const DoctorOptions& options, const Streams& to) {
  std::optional<BridgeSpec> spec;
  if (!options.config.empty()) {
    spec = load_configuration(options.config, to.err);
    if (!spec) return ExitCode::kUsage;
  }
  MachineFacts facts = gather_facts(options.root, spec ? &*spec : nullptr);
  if (!options.config.empty() && options.root == "/")  // compares clocks in its domain
    gather_clocks({.config = options.config, .security = options.security}, facts);
  const auto findings = findings_of(facts);
  if (options.json) {
    for (const Finding& finding : findings) to.out << finding_json(finding).text() << '\n';
  } else {
    print(to.out, doctor_lines(findings, to.wide_screen()));
  }
  to.out.flush();
  return worst_of(findings) == Severity::kPrevents ? ExitCode::kFound : ExitCode::kOk;
}

namespace {

void describe_doctor(CommandLine& line, DoctorOptions& options) {
  line.text("CONFIG", options.config, "The configuration file; without it the machine alone")
      .existing_file();
  line.flag("--json", options.json, "JSON lines");
  line.text("--root", options.root,
            "Look at /proc, /sys, /run and the ports below this folder (/)");
  line.text("--security", options.security,
            "Join the domain of CONFIG as the member whose folder this is, to compare clocks");
}

}  // namespace

CommandRow doctor_command() {
  return command_row("doctor",
                     "What of this machine is in Fieldcast's way, and the remedy; needs no bridge",
                     describe_doctor, doctor);
}

namespace {

// To `err`, so that `out` is identical for the same seed.
void tell_speed(const BusSimulation& simulation, Duration took, std::ostream& err) {
  err << simulation.plan->bus->name << ": " << to_text(simulation.options.length)
      << " of virtual time in " << std::fixed << std::setprecision(2) << to_seconds(took) << " s, "
      << std::setprecision(0) << to_seconds(simulation.options.length) / to_seconds(took)
      << " times as fast as the wire\n";
}

ExitCode simulate_all(const BridgeSpec& spec, const PlanOptions& options, const Streams& to) {
  sim::Faults faults;
  if (!options.faults.empty()) {
    auto loaded = sim::load_faults(options.faults, spec);
    if (!loaded) {
      to.err << config::to_text(loaded.error()) << '\n';
      return ExitCode::kUsage;
    }
    faults = *std::move(loaded);
  }
  auto verdict = ExitCode::kOk;
  bool first = true;
  for (const auto& bus : spec.buses) {
    const auto plan = make_plan(bus, options.response_time);
    const auto began = std::chrono::steady_clock::now();
    ProgressLine progress(to.err);
    const auto show = [&](double share) {
      progress.show([&](Duration elapsed) {
        return progress_text("simulating " + bus.name, share, elapsed);
      });
    };
    const auto simulation =
        simulate(plan, faults.buses[bus.name], {options.simulate, options.seed}, show);
    progress.clear();
    const Duration took = std::chrono::steady_clock::now() - began;
    if (simulation.bus.deadline_misses != 0) verdict = ExitCode::kFound;
    if (options.json) {
      to.out << simulation_json(simulation).text() << '\n';
    } else {
      if (!std::exchange(first, false)) to.out << '\n';
      print(to.out, simulation_lines(simulation, to.wide_screen()));
    }
    to.out.flush();
    tell_speed(simulation, took, to.err);
  }
  return verdict;
}

}  // namespace

ExitCode plan(const PlanOptions& options, const Streams& to) {
  config::LoadOptions load = config::default_options();
  load.refuse_hopeless = false;  // this command explains how to fix such a bus
  const auto loaded = load_configuration(options.config, to.err, load);
  if (!loaded) return ExitCode::kUsage;
  if (options.simulate > Duration::zero()) return simulate_all(*loaded, options, to);
  auto verdict = ExitCode::kOk;
  bool first = true;
  for (const auto& bus : loaded->buses) {
    const auto plan = make_plan(bus, options.response_time);
    if (!plan.prediction.feasible) verdict = ExitCode::kFound;
    if (options.json) {
      to.out << plan_json(plan).text() << '\n';
    } else {
      if (!std::exchange(first, false)) to.out << '\n';
      print(to.out, plan_lines(plan, to.wide_screen()));
    }
    to.out.flush();  // a signal ends the command at any time
  }
  return verdict;
}

namespace {

void describe_plan(CommandLine& line, PlanOptions& options) {
  line.text("CONFIG", options.config, "The configuration file").required().existing_file();
  line.duration("--answer", options.response_time, Duration{},
                "The assumed time of each device before it responds (5ms)");
  line.duration("--simulate", options.simulate, CommandLine::kShortest,
                "Run the whole engine in virtual time for so long (1h) against simulated devices");
  line.number("--seed", options.seed, "Of the simulation: one seed repeats it to the letter (1)")
      .needs("--simulate");
  line.text("--faults", options.faults,
            "What goes wrong in the simulated plant: a file as fieldcast-sim takes it")
      .existing_file()
      .needs("--simulate");
  line.flag("--json", options.json, "JSON lines");
}

}  // namespace

CommandRow plan_command() {
  return command_row(
      "plan", "Predict blocks, load and gaps of every bus of a configuration; needs no bridge",
      describe_plan, ends_at_once(plan));
}

}  // namespace fieldcast::cli
