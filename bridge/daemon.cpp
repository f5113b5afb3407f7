#include "bridge/daemon.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <optional>

#include "bridge/base/clock.hpp"
#include "bridge/bridge.hpp"
#include "bridge/capture/capture_folder.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/dds/receivers/sample_load.hpp"
#include "bridge/dds/transport/join_check.hpp"
#include "bridge/log/log.hpp"
#include "bridge/process/secret.hpp"
#include "bridge/program/server.hpp"
#include "bridge/service/process_watch.hpp"
#include "bridge/service/service.hpp"
#include "config/loader/loader.hpp"
#include "core/base/message_text.hpp"
#include "core/bus/wire/fence_setup.hpp"
#include "core/model/overlap.hpp"
#include "core/schedule/bus_schedule.hpp"
#include "core/schedule/overload.hpp"

namespace fieldcast {
namespace {

// Time between two summaries of counted lines.
constexpr Duration kHousekeeping = std::chrono::seconds{10};
constexpr Duration kLastWords = std::chrono::milliseconds{300};  // for the log to be written

// Counted, because messages of the library can be caused by any sender in the domain.
void log_library(bool error, std::string_view kind, std::string_view text) {
  if (kind == kSecurityLine)
    return error ? log_error("security", text) : log_warning("security", text);
  log_counted(error ? LogLevel::kError : LogLevel::kWarning, "Fast DDS",
              fmt::format("messages of {}", kind), text);
}

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

// Reports buses that cannot keep their refresh times, and the remedy. Used at start and reload.
template <typename Tell>
void tell_overloads(const BridgeSpec& spec, Tell tell) {
  for (const BusSpec& bus : spec.buses) {
    if (const auto overload = overload_of(bus, kAssumedAnswerTime))
      tell(bus.name, to_text(*overload));
  }
}

constexpr std::size_t kOverlapsTold = 20;  // per bus; the rest is only counted

// Reports channels that read the same items as different types. Used by --check.
template <typename Tell>
void tell_overlaps(const BridgeSpec& spec, Tell tell) {
  for (const BusSpec& bus : spec.buses) {
    const std::vector<Overlap> overlaps = overlaps_of(bus);
    for (std::size_t i = 0; i < std::min(overlaps.size(), kOverlapsTold); ++i)
      tell(bus.name, to_text(overlaps[i]));
    if (overlaps.size() > kOverlapsTold)
      tell(bus.name, fmt::format("{} more channels overlap", overlaps.size() - kOverlapsTold));
  }
}

void log_overloads(const BridgeSpec& spec) {
  tell_overloads(spec,
                 [](const std::string& bus, const std::string& text) { log_warning(bus, text); });
}

// Reports the fence of each bus that may have a second master; in a standby group, of every bus.
template <typename Say, typename Warn>
void tell_fences(const BridgeSpec& spec, Say say, Warn warn) {
  for (const BusSpec& bus : spec.buses) {
    if (!spec.standby && !fence_of(bus.port).kind) continue;
    const FenceText fence = fence_text(bus);
    if (fence.missing && spec.standby)
      warn(bus.name, "fence: " + fence.text);
    else
      say(bus.name, "fence: " + fence.text);
  }
}

void log_fences(const BridgeSpec& spec) {
  tell_fences(
      spec, [](const std::string& bus, const std::string& text) { log_info(bus, text); },
      [](const std::string& bus, const std::string& text) { log_warning(bus, text); });
}

JoinCheck check_joining(const BridgeSpec& spec) {
  return check_joining(spec.dds, spec.name, read_clocks().utc);
}

template <typename Tell>
void tell_access(const ProgramSpec& spec, Tell tell) {
  if (spec.engineers) tell(program::to_text(*spec.engineers));
  if (spec.modules) tell(program::to_text(*spec.modules));
}

void log_joining(const JoinCheck& joining) {
  for (const JoinRemark& remark : joining.faults) log_error(remark.of, remark.text);
  for (const JoinRemark& remark : joining.warnings) log_warning(remark.of, remark.text);
}

constexpr const char* kOpen = "security: none: every program in the network can read and command";

void log_faults(const std::vector<config::Fault>& faults) {
  for (const config::Fault& fault : faults) log_error("configuration", config::to_text(fault));
}

// A reload, including its wait while engineers use devices that it would restart.
class Reloader {
 public:
  static constexpr Duration kTryAgain = std::chrono::milliseconds{250};
  static constexpr Duration kSayAgain = std::chrono::minutes{1};
  static constexpr Duration kGiveUp = std::chrono::hours{1};
  static constexpr const char* kRefused = "not reloaded: the old configuration goes on running";

  // `running`: buses_text() of the configuration that the bridge started with.
  Reloader(Bridge& bridge, IdentityWatch& identity, std::string path, std::string running)
      : bridge_(bridge),
        identity_(identity),
        path_(std::move(path)),
        running_(std::move(running)) {}

  // Loads the file again; a reload that still waits is dropped.
  void begin() {
    wanted_.reset();
    refused_ = false;
    config::Loaded loaded = config::load_file(path_);
    if (!loaded) {
      refused_ = true;
      log_faults(loaded.error());
      return log_error("configuration", kRefused);
    }
    const JoinCheck joining = check_joining(*loaded);
    log_joining(joining);
    if (!joining.faults.empty()) {
      refused_ = true;
      return log_error("configuration", kRefused);
    }
    open_log(loaded->log.level);
    log_overloads(*loaded);
    log_fences(*loaded);
    wanted_ = *std::move(loaded);
    begun_ = steady_now();
    say_at_ = begun_;
    go_on();
  }
  [[nodiscard]] bool waits() const { return wanted_.has_value(); }
  [[nodiscard]] std::string status() const {
    if (refused_) return running_ + "; the last reload was refused, the log says why";
    return waits() ? running_ + "; a reload waits for the end of programming" : running_;
  }
  void go_on() {
    const auto done = bridge_.reload(*wanted_);
    if (!done) {
      wanted_.reset();
      refused_ = true;
      return log_error("configuration",
                       "not reloaded, the old configuration goes on running: " + done.error());
    }
    if (done->waits_for.empty()) {
      running_ = buses_text(*wanted_);
      identity_.joined(wanted_->dds, read_clocks().utc);
      return wanted_.reset();
    }
    const Instant now = steady_now();
    const std::string who = fmt::format("{}", fmt::join(done->waits_for, ", "));
    if (now - begun_ >= kGiveUp) {
      wanted_.reset();
      refused_ = true;
      return log_error("configuration",
                       fmt::format("not reloaded, the old configuration goes on running: still "
                                   "programmed after {}: {}; send SIGHUP again when that has ended",
                                   to_text(kGiveUp), who));
    }
    if (now < say_at_) return;
    say_at_ = now + kSayAgain;
    log_warning("configuration",
                fmt::format("not reloaded yet, the old configuration goes on running: the reload "
                            "waits for the end of programming: {}; after {} it is given up",
                            who, to_text(kGiveUp - (now - begun_) / kSayAgain * kSayAgain)));
  }

 private:
  Bridge& bridge_;
  IdentityWatch& identity_;
  const std::string path_;
  std::string running_;
  std::optional<BridgeSpec> wanted_;  // set while the reload waits
  bool refused_ = false;              // the last reload was refused
  Instant begun_{}, say_at_{};
};

class WhileItLives {
 public:
  WhileItLives(Signals& signals, Bridge& bridge) : signals_(signals) {
    signals_.if_stuck([&bridge] { last_words(bridge); });
  }
  ~WhileItLives() { signals_.if_stuck({}); }
  WhileItLives(const WhileItLives&) = delete;
  WhileItLives& operator=(const WhileItLives&) = delete;

 private:
  Signals& signals_;
};

ExitCode serve(Signals& signals, const BridgeSpec& spec, const DaemonOptions& options) {
  log_overloads(spec);
  log_fences(spec);
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
  tell_access(spec.program, [](const std::string& text) { log_info("program", text); });
  Bridge bridge;
  const WhileItLives watched(signals, bridge);
  bool trace = options.trace;
  bridge.set_trace(trace);
  if (const auto started = bridge.start(spec, [&signals] { return signals.ending(); }); !started) {
    log_error(spec.name, "cannot start: " + started.error());
    return ExitCode::kCannotStart;
  }
  log_info(spec.name, "running: " + buses_text(spec));
  Service service(notify_address(), watchdog_limit());
  Reloader reloader(bridge, identity, options.configuration, buses_text(spec));
  service.ready(reloader.status());
  for (;;) {
    if (service.watched()) service.look(bridge.turns(), steady_now());
    const Duration sleep = service.sleep(reloader.waits() ? Reloader::kTryAgain : kHousekeeping);
    switch (const int signal = signals.wait(sleep)) {
      case 0:
        log_summaries(steady_now());
        identity.look(read_clocks().utc);
        if (!reloader.waits()) break;
        reloader.go_on();
        if (!reloader.waits()) service.status(reloader.status());
        break;
      case SIGHUP:
        service.reloading(steady_now());
        reloader.begin();
        service.ready(reloader.status());
        break;
      case SIGUSR1:
        trace = !trace;
        bridge.set_trace(trace);
        log_info("trace", trace ? "on" : "off");
        break;
      default:
        log_info(spec.name, fmt::format("stopping ({})", ::sigabbrev_np(signal)));
        service.stopping();
        bridge.stop();
        log_info(spec.name, "stopped");
        return ExitCode::kOk;
    }
  }
}

// What the configuration names and this machine does not have as it should be: each with its place
// in the file.
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

}  // namespace

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
  tell_access(loaded->program,
              [](const std::string& text) { std::printf("  %s\n", text.c_str()); });
  const auto warn = [](const std::string& bus, const std::string& text) {
    std::fputs(fmt::format("warning: {}: {}\n", bus, text).c_str(), stderr);
  };
  tell_overloads(*loaded, warn);
  tell_overlaps(*loaded, warn);
  tell_fences(
      *loaded,
      [](const std::string& bus, const std::string& text) {
        std::fputs(fmt::format("{}: {}\n", bus, text).c_str(), stdout);
      },
      warn);
  if (const auto small = rate_remark(*loaded)) warn("dds", *small);
  if (loaded->dds.without_security) warn("dds", kOpen);
  return check_machine(*loaded, places);
}

ExitCode run_daemon(const DaemonOptions& options) {
  Signals signals;
  const config::Loaded loaded = config::load_file(options.configuration);
  if (!loaded) {
    std::fputs(config::to_text(loaded.error()).c_str(), stderr);
    return ExitCode::kBadConfiguration;
  }
  open_log(loaded->log.level);
  if (const std::string memory = unguarded_memory(); !memory.empty())
    log_warning("security", memory);
  set_library_lines(log_library);
  const ExitCode code = serve(signals, *loaded, options);
  flush_log(kLastWords);
  return code;
}

}  // namespace fieldcast
