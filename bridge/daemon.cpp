#include "bridge/daemon.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <cstdio>
#include <cstring>

#include "bridge/bridge.hpp"
#include "bridge/log.hpp"
#include "config/loader.hpp"
#include "core/schedule/bus_schedule.hpp"
#include "core/schedule/overload.hpp"

namespace fieldcast {
namespace {

// Waits for our signals in the main thread; everywhere else they are blocked.
class Signals {
 public:
  Signals() {
    sigemptyset(&set_);
    for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGUSR1}) sigaddset(&set_, signal);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
    ::signal(SIGPIPE, SIG_IGN);  // of stdout, when nobody reads the trace any more
  }
  [[nodiscard]] int wait() const {
    int signal = 0;
    while (sigwait(&set_, &signal) != 0) {}
    return signal;
  }

 private:
  sigset_t set_;
};

std::string summary(const BridgeSpec& spec) {
  std::string text = fmt::format("bridge {}: {} buses, DDS domain {}\n", spec.name, spec.buses.size(), spec.dds.domain);
  for (const BusSpec& bus : spec.buses) {
    std::size_t channels = 0;
    for (const DeviceSpec& device : bus.devices) channels += device.channels.size();
    text += fmt::format("  {}: {}, {} devices, {} channels\n", bus.name, to_text(bus.port), bus.devices.size(), channels);
  }
  return text;
}

// Buses that will not keep their refreshes, and what to do: told where a configuration is taken up.
template <typename Tell>
void tell_overloads(const BridgeSpec& spec, Tell tell) {
  for (const BusSpec& bus : spec.buses) {
    if (const auto overload = overload_of(bus, kAssumedAnswerTime)) tell(bus.name, to_text(*overload));
  }
}

void log_overloads(const BridgeSpec& spec) {
  tell_overloads(spec, [](const std::string& bus, const std::string& text) { log_warning(bus, text); });
}

void log_faults(const std::vector<config::Fault>& faults) {
  for (const config::Fault& fault : faults) log_error("configuration", config::to_text(fault));
}

void reload(Bridge& bridge, const std::string& path) {
  const config::Loaded wanted = config::load_file(path);
  if (!wanted) {
    log_faults(wanted.error());
    return log_error("configuration", "not reloaded: the old configuration goes on running");
  }
  open_log(wanted->log.level);
  log_overloads(*wanted);
  if (const auto done = bridge.reload(*wanted); !done) {
    log_error("configuration", "not reloaded, the old configuration goes on running: " + done.error());
  }
}

}  // namespace

ExitCode check_configuration(const std::string& path) {
  const config::Loaded loaded = config::load_file(path);
  if (!loaded) {
    std::fputs(config::to_text(loaded.error()).c_str(), stderr);
    return ExitCode::kBadConfiguration;
  }
  std::fputs(summary(*loaded).c_str(), stdout);
  tell_overloads(*loaded, [](const std::string& bus, const std::string& text) {
    std::fputs(fmt::format("warning: {}: {}\n", bus, text).c_str(), stderr);
  });
  return ExitCode::kOk;
}

ExitCode run_daemon(const DaemonOptions& options) {
  const Signals signals;
  const config::Loaded loaded = config::load_file(options.configuration);
  if (!loaded) {
    std::fputs(config::to_text(loaded.error()).c_str(), stderr);
    return ExitCode::kBadConfiguration;
  }
  open_log(loaded->log.level);
  log_overloads(*loaded);
  bool trace = options.trace;
  Bridge bridge;
  bridge.set_trace(trace);
  if (const auto started = bridge.start(*loaded); !started) {
    log_error(loaded->name, "cannot start: " + started.error());
    return ExitCode::kCannotStart;
  }
  log_info(loaded->name, fmt::format("running: {} buses, DDS domain {}", loaded->buses.size(), loaded->dds.domain));

  for (;;) {
    switch (const int signal = signals.wait()) {
      case SIGHUP: reload(bridge, options.configuration); break;
      case SIGUSR1:
        trace = !trace;
        bridge.set_trace(trace);
        log_info("trace", trace ? "on" : "off");
        break;
      default:
        log_info(loaded->name, fmt::format("stopping ({})", ::sigabbrev_np(signal)));
        bridge.stop();
        log_info(loaded->name, "stopped");
        return ExitCode::kOk;
    }
  }
}

}  // namespace fieldcast
