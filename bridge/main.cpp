// fieldcast-bridge CONFIG [--check]: polls PLCs, publishes their channels on DDS, runs commands.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <string>

#include "bridge/base/clock.hpp"
#include "bridge/base/exit_code.hpp"
#include "bridge/bridge.hpp"
#include "bridge/capture/capture_folder.hpp"
#include "bridge/configure/configuration_service.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/dds/receivers/sample_load.hpp"
#include "bridge/dds/transport/join_check.hpp"
#include "bridge/log/log.hpp"
#include "bridge/process/command_line.hpp"
#include "bridge/process/secret.hpp"
#include "bridge/program/server.hpp"
#include "bridge/service/library_log.hpp"
#include "bridge/service/process_watch.hpp"
#include "bridge/service/service.hpp"
#include "config/loader/loader.hpp"
#include "core/base/message_text.hpp"
#include "core/bus/wire/fence_setup.hpp"
#include "core/model/channel_pattern.hpp"
#include "core/model/overlap.hpp"
#include "core/model/reach.hpp"
#include "core/schedule/bus_schedule.hpp"
#include "core/schedule/overload.hpp"

namespace fieldcast {
namespace {

// Time between two summaries of counted lines.
constexpr Duration kHousekeeping = std::chrono::seconds{10};

// Ends the process when a library or a driver hangs and blocks the stop.
void last_words(Bridge& bridge) {
  log_error("bridge", fmt::format("not stopped within {}, while {}: the process ends",
                                  to_text(Signals::kEndLimit), bridge.busy_with()));
  bridge.save(std::chrono::seconds{1});
  flush_log(kLastWords);
}

std::string summary(const BridgeSpec& spec) {
  std::string text = fmt::format("bridge {}: {}\n", spec.name, buses_text(spec));
  for (const BusSpec& bus : spec.buses) {
    std::size_t channels = 0;
    for (const DeviceSpec& device : bus.devices) channels += device.channels.size();
    text += fmt::format("  {}: {}, {}, {}\n", bus.name, to_text(bus.port),
                        counted(bus.devices.size(), "device", "devices"),
                        counted(channels, "channel", "channels"));
  }
  return text;
}

// Where remarks go: the log, or with --check the terminal.
using Report = void (*)(std::string_view subject, std::string_view text);

void print(std::string_view subject, std::string_view text) {
  std::fputs(fmt::format("{}: {}\n", subject, text).c_str(), stdout);
}
void print_warning(std::string_view subject, std::string_view text) {
  std::fputs(fmt::format("warning: {}: {}\n", subject, text).c_str(), stderr);
}

// Reports buses that cannot keep their refresh times, and the remedy.
void report_overloads(const BridgeSpec& spec, Report warn) {
  for (const BusSpec& bus : spec.buses) {
    if (const auto overload = overload_of(bus, kAssumedResponseTime))
      warn(bus.name, to_text(*overload));
  }
}

// Reports the first texts about a bus; the rest is only counted: "7 more channels overlap".
void report_first(const std::string& bus, const std::vector<std::string>& texts,
                  std::string_view more, Report warn) {
  constexpr std::size_t kReported = 20;
  for (std::size_t i = 0; i < std::min(texts.size(), kReported); ++i) warn(bus, texts[i]);
  if (texts.size() > kReported)
    warn(bus, fmt::format("{} more {}", texts.size() - kReported, more));
}

// Reports channels that read the same items as different types.
void report_overlaps(const BridgeSpec& spec, Report warn) {
  for (const BusSpec& bus : spec.buses) {
    std::vector<std::string> texts;
    for (const Overlap& overlap : overlaps_of(bus)) texts.push_back(to_text(overlap));
    report_first(bus.name, texts, "channels overlap", warn);
  }
}

// Reports alarm limits that the type of the channel cannot exceed.
void report_limits(const BridgeSpec& spec, Report warn) {
  for (const BusSpec& bus : spec.buses)
    report_first(bus.name, unreachable_limits(bus), "limits cannot be reached", warn);
}

// Reports patterns of the store by which no sample is kept.
void report_patterns(const BridgeSpec& spec, Report warn) {
  if (!spec.store) return;
  for (const std::string& text : spec.store->samples) {
    const auto pattern = Pattern::parse(text);
    const auto in_bus = [&](const BusSpec& bus) {
      return std::ranges::any_of(bus.devices, [&](const DeviceSpec& device) {
        return std::ranges::any_of(device.channels, [&](const ChannelSpec& channel) {
          return pattern->matches(bus.name, device.name, channel.name);
        });
      });
    };
    if (pattern && std::ranges::none_of(spec.buses, in_bus))
      warn("store", fmt::format("samples: no channel matches {}", text));
  }
}

// Reports calculated channels that combine different units.
void report_calculations(const BridgeSpec& spec, Report warn) {
  for (const BusSpec& bus : spec.buses)
    for (const DeviceSpec& device : bus.devices)
      for (const ChannelSpec& channel : device.channels)
        if (channel.calculation && !channel.calculation.value->remark.empty())
          warn(bus.name, channel.calculation.value->remark);
}

// Reports the fence of each bus that may have a second master; in a standby group, of every bus.
void report_fences(const BridgeSpec& spec, Report say, Report warn) {
  for (const BusSpec& bus : spec.buses) {
    if (!spec.standby && !fence_of(bus.port).kind) continue;
    const FenceText fence = fence_text(bus);
    (fence.missing && spec.standby ? warn : say)(bus.name, "fence: " + fence.text);
  }
}

JoinCheck check_joining(const BridgeSpec& spec) {
  return check_joining(spec.dds, spec.name, read_clocks().utc);
}

void report_access(const ProgramSpec& spec, Report say) {
  if (spec.engineers) {
    say("program", program::to_text(*spec.engineers));
    for (const EngineerPortSpec& port : spec.engineers->ports)
      say("program", program::to_text(*spec.engineers, port));
  }
  if (spec.modules) say("program", program::to_text(*spec.modules));
}

void log_joining(const JoinCheck& joining) {
  for (const JoinRemark& remark : joining.faults) log_error(remark.of, remark.text);
  for (const JoinRemark& remark : joining.warnings) log_warning(remark.of, remark.text);
}

constexpr const char* kOpen = "security: none: every program in the network can read and command";

// A reload, including its wait while engineers use devices that it would restart.
class Reloader {
 public:
  static constexpr Duration kTryAgain = std::chrono::milliseconds{250};
  static constexpr Duration kStartAgain = std::chrono::seconds{2};
  static constexpr Duration kSayAgain = std::chrono::minutes{1};
  static constexpr Duration kGiveUp = std::chrono::hours{1};

  // `running`: buses_text() of the configuration that the bridge started with.
  Reloader(Bridge& bridge, ConfigurationService& configuration, IdentityWatch& identity,
           std::string path, std::string running)
      : bridge_(bridge),
        configuration_(configuration),
        identity_(identity),
        path_(std::move(path)),
        running_(std::move(running)) {}

  // Loads the file again; a reload that still waits is dropped.
  void begin() {
    wanted_.reset();
    refused_ = false;
    config::Loaded loaded = config::load_file(path_);
    if (!loaded) {
      for (const config::Fault& fault : loaded.error())
        log_error("configuration", config::to_text(fault));
      configuration_.reloaded(config::to_text(loaded.error().front()));
      return refuse_file();
    }
    const JoinCheck joining = check_joining(*loaded);
    log_joining(joining);
    if (!joining.faults.empty()) {
      configuration_.reloaded(joining.faults.front().text);
      return refuse_file();
    }
    open_log(loaded->log.level);
    report_overloads(*loaded, log_warning);
    report_fences(*loaded, log_info, log_warning);
    begin_with(*std::move(loaded));
  }
  // Joins the domain again with the running configuration, or with that of the reload that waits.
  void join_again() {
    bridge_.was_removed();
    begin_with(waits() ? *wanted_ : bridge_.configuration());
  }
  [[nodiscard]] bool waits() const { return wanted_.has_value(); }
  // Longest time until go_on() or start_again() must be called.
  [[nodiscard]] Duration sleep() const {
    return waits() ? kTryAgain : is_down_ ? kStartAgain : kHousekeeping;
  }
  [[nodiscard]] bool is_down() const { return is_down_; }
  // The reload failed, and so did the return to the old configuration.
  void start_again() {
    if (!bridge_.reload(bridge_.configuration())) return;
    is_down_ = false;
    log_info("configuration", "the old configuration runs again");
  }
  [[nodiscard]] std::string status() const {
    if (is_down_) return "no bus runs: the last reload failed, the log says why";
    if (refused_) return running_ + "; the last reload was refused, the log says why";
    return waits() ? running_ + "; a reload waits for the end of programming" : running_;
  }
  void go_on() {
    const auto done = bridge_.reload(*wanted_);
    is_down_ = !bridge_.is_running();
    if (!done) configuration_.reloaded(done.error());
    if (!done && is_down_)
      return refuse(
          fmt::format("not reloaded, and the old configuration does not start again, so "
                      "no bus runs; that is tried every {}: {}",
                      to_text(kStartAgain), done.error()));
    if (!done)
      return refuse("not reloaded, the old configuration goes on running: " + done.error());
    if (done->waits_for.empty()) {
      running_ = buses_text(*wanted_);
      identity_.joined(wanted_->dds, read_clocks().utc);
      configuration_.refuse_for(refusal_of_requests(*wanted_, stays_on_this_machine(wanted_->dds)));
      configuration_.reloaded("");
      return wanted_.reset();
    }
    const Instant now = steady_now();
    const std::string who = fmt::format("{}", fmt::join(done->waits_for, ", "));
    if (now - begun_ >= kGiveUp)
      return refuse(
          fmt::format("not reloaded, the old configuration goes on running: still programmed after "
                      "{}: {}; send SIGHUP again when that has ended",
                      to_text(kGiveUp), who));
    if (now < say_at_) return;
    say_at_ = now + kSayAgain;
    log_warning("configuration",
                fmt::format("not reloaded yet, the old configuration goes on running: the reload "
                            "waits for the end of programming: {}; after {} it is given up",
                            who, to_text(kGiveUp - (now - begun_) / kSayAgain * kSayAgain)));
  }

 private:
  void begin_with(BridgeSpec wanted) {
    wanted_ = std::move(wanted);
    begun_ = steady_now();
    say_at_ = begun_;
    go_on();
  }
  void refuse_file() {
    refuse(is_down_ ? "not reloaded: no bus runs"
                    : "not reloaded: the old configuration goes on running");
  }
  void refuse(const std::string& why) {
    wanted_.reset();
    refused_ = true;
    log_error("configuration", why);
  }

  Bridge& bridge_;
  ConfigurationService& configuration_;
  IdentityWatch& identity_;
  const std::string path_;
  std::string running_;
  std::optional<BridgeSpec> wanted_;  // set while the reload waits
  bool refused_ = false;              // the last reload was refused
  bool is_down_ = false;              // nothing runs
  Instant begun_{}, say_at_{};
};

configure::ConfigurationAgent::Ports configuration_ports(Bridge& bridge) {
  return {.reload = [] { ::kill(::getpid(), SIGHUP); },
          .qualities = [&bridge] { return bridge.qualities(); },
          .audit =
              [&bridge](AuditEntry entry) {
                log_info("configuration",
                         fmt::format("{} by {}: {}", entry.what, entry.who, entry.result));
                bridge.note(std::move(entry));
              },
          .clock = [] { return read_clocks(); },
          .probe =
              [&bridge](const std::string& bus, DeviceProbe&& probe, BusRunner::Probed&& done) {
                return bridge.probe(bus, std::move(probe), std::move(done));
              }};
}

ExitCode serve(Signals& signals, const BridgeSpec& spec, const std::string& path, bool trace) {
  report_overloads(spec, log_warning);
  report_fences(spec, log_info, log_warning);
  const JoinCheck joining = check_joining(spec);
  log_joining(joining);
  if (!joining.faults.empty()) {
    log_error(spec.name, "cannot start: what it joins with is not in order");
    return ExitCode::kBadConfiguration;
  }
  IdentityWatch identity(true);
  identity.joined(spec.dds, read_clocks().utc);
  if (spec.dds.without_security) log_warning("dds", kOpen);
  if (const auto small = rate_remark(spec)) log_warning("dds", *small);
  report_access(spec.program, log_info);
  ConfigurationService* receiver = nullptr;  // set before the bridge starts
  Bridge bridge([&receiver](ConfigurationMessage request, std::string subject, std::string fault) {
    receiver->receive(std::move(request), std::move(subject), std::move(fault));
  });
  ConfigurationService configuration(
      path, configuration_ports(bridge),
      [&bridge](const ConfigurationMessage& reply) { bridge.respond(reply); });
  receiver = &configuration;
  const auto watched = signals.if_stuck([&bridge] { last_words(bridge); });
  bridge.set_trace(trace);
  if (const auto started = bridge.start(spec, [&signals] { return signals.ending(); }); !started) {
    log_error(spec.name, "cannot start: " + started.error());
    return ExitCode::kCannotStart;
  }
  log_info(spec.name, "running: " + buses_text(spec));
  Service service(notify_address(), watchdog_limit());
  configuration.refuse_for(refusal_of_requests(spec, stays_on_this_machine(spec.dds)));
  Reloader reloader(bridge, configuration, identity, path, buses_text(spec));
  service.ready(reloader.status());
  for (;;) {
    if (service.watched()) service.look(bridge.turns(), steady_now());
    const int signal = signals.wait(service.sleep(reloader.sleep()));
    switch (signal) {
      case 0:
        log_summaries(steady_now());
        identity.look(read_clocks().utc);
        if (reloader.is_down()) {
          reloader.start_again();
          if (!reloader.is_down()) service.status(reloader.status());
        }
        if (!reloader.waits()) break;
        reloader.go_on();
        if (!reloader.waits()) service.status(reloader.status());
        break;
      case SIGHUP:
        service.reloading(steady_now());
        reloader.begin();
        service.ready(reloader.status());
        break;
      case Signals::kRemoved:
        reloader.join_again();
        service.status(reloader.status());
        break;
      case SIGUSR1:
        trace = !trace;
        bridge.set_trace(trace);
        log_info("trace", trace ? "on" : "off");
        break;
      default:
        log_info(spec.name, fmt::format("stopping ({})", ::sigabbrev_np(signal)));
        service.stopping();
        configuration.close();
        bridge.stop();
        log_info(spec.name, "stopped");
        return ExitCode::kOk;
    }
  }
}

// Reports each configured item that this machine lacks, with its place in the file.
ExitCode check_machine(const BridgeSpec& spec, const config::Places& places) {
  const auto say = [&places](const std::string& key, const std::string& text) {
    std::fputs(fmt::format("{}: {}\n", places.at(key), text).c_str(), stderr);
  };
  for (const CaptureRemark& remark : capture_remarks(spec)) {
    say(fmt::format("buses.{}.capture.folder", remark.index),
        fmt::format("warning: {}: capture: {}: {}; {}", remark.bus, remark.folder, remark.what,
                    remark.remedy));
  }
  const JoinCheck joining = check_joining(spec);
  for (const JoinRemark& remark : joining.warnings)
    say("dds." + remark.key, "warning: " + to_text(remark));
  for (const JoinRemark& remark : joining.faults) say("dds." + remark.key, to_text(remark));
  const auto file = program::check_files(spec.program);
  if (file) say("program." + file->key, "program: " + file->text);
  return joining.faults.empty() && !file ? ExitCode::kOk : ExitCode::kBadConfiguration;
}

// Prints every fault of the file, or a summary of the configuration.
ExitCode check_configuration(const std::string& path) {
  config::Places places;
  config::LoadOptions options = config::default_options();
  options.places = &places;
  const config::Loaded loaded = config::load_file(path, options);
  if (!loaded) {
    std::fputs(config::to_text(loaded.error()).c_str(), stderr);
    return ExitCode::kBadConfiguration;
  }
  std::fputs(summary(*loaded).c_str(), stdout);
  report_access(loaded->program, [](std::string_view, std::string_view text) {
    std::fputs(fmt::format("  {}\n", text).c_str(), stdout);
  });
  report_overloads(*loaded, print_warning);
  report_overlaps(*loaded, print_warning);
  report_limits(*loaded, print_warning);
  report_patterns(*loaded, print_warning);
  report_calculations(*loaded, print_warning);
  report_fences(*loaded, print, print_warning);
  if (const auto small = rate_remark(*loaded)) print_warning("dds", *small);
  if (loaded->dds.without_security) print_warning("dds", kOpen);
  return check_machine(*loaded, places);
}

// The versions must not prevent a start.
std::string recovered_configuration(const std::string& path) {
  try {
    return configure::recover_configuration(path);
  } catch (const std::exception& error) { return error.what(); }
}

// Runs until SIGTERM or SIGINT. SIGHUP reloads the file; SIGUSR1 switches the wire trace.
ExitCode run_daemon(const std::string& path, bool trace) {
  Signals signals;  // before any other thread: only later threads inherit its signal mask
  const std::string recovered = recovered_configuration(path);
  const config::Loaded loaded = config::load_file(path);
  if (!loaded) {
    std::fputs(config::to_text(loaded.error()).c_str(), stderr);
    return ExitCode::kBadConfiguration;
  }
  open_log(loaded->log.level);
  if (!recovered.empty()) log_warning("configuration", recovered);
  if (const std::string memory = unguarded_memory(); !memory.empty())
    log_warning("security", memory);
  log_library_messages();
  const ExitCode code = serve(signals, *loaded, path, trace);
  flush_log(kLastWords);
  return code;
}

ExitCode run(int argc, char** argv) {
  CommandLine line("fieldcast-bridge",
                   "Publishes the channels of PLCs on DDS and carries commands back.");
  line.set_footer(
      "Signals: SIGHUP reloads the file, SIGUSR1 switches the wire trace, SIGTERM and SIGINT stop "
      "in order.\n"
      "Exit codes: 0 in order, 1 a fault of the program, 2 command line, 3 faults in the "
      "configuration, 4 DDS cannot be joined or the programming server cannot listen, 5 a driver "
      "or a library hung during the stop.");
  std::string path;
  bool check = false, trace = false;
  line.text("CONFIG", path, "the configuration (YAML)").required();
  line.flag("--check", check, "only report the faults of the configuration");
  line.flag("--trace", trace, "write every frame to stdout from the start");
  if (const auto fault = line.parse_or_print(argc, argv))
    return *fault ? ExitCode::kUsage : ExitCode::kOk;
  return check ? check_configuration(path) : run_daemon(path, trace);
}

}  // namespace
}  // namespace fieldcast

int main(int argc, char** argv) {
  return fieldcast::daemon_main("bridge", [&] { return fieldcast::run(argc, argv); });
}
