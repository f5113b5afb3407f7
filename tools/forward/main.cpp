// fieldcast-forward: forwards what a DDS domain publishes to a message engine.
#include <fmt/format.h>
#include <signal.h>

#include <cstdio>
#include <optional>

#include "bridge/base/clock.hpp"
#include "bridge/base/exit_code.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/dds/transport/join_check.hpp"
#include "bridge/log/log.hpp"
#include "bridge/metrics/metrics_server.hpp"
#include "bridge/process/command_line.hpp"
#include "bridge/service/library_log.hpp"
#include "bridge/service/process_watch.hpp"
#include "bridge/service/service.hpp"
#include "tools/forward/forward_metrics.hpp"
#include "tools/forward/forwarder.hpp"
#include "tools/forward/settings/configuration.hpp"

namespace {

using fieldcast::ExitCode;
using namespace fieldcast::forward;

constexpr fieldcast::Duration kHousekeeping = std::chrono::seconds{10};
constexpr const char* kOpen = "security: none: every program in the network can read and command";

// Also prints a successful check, so that an empty output is never a success.
ExitCode check(const ForwardSpec& spec, const fieldcast::config::Places& places) {
  const auto joining = fieldcast::check_joining(spec.dds, {}, fieldcast::read_clocks().utc);
  const auto print = [&places](const fieldcast::JoinRemark& remark, const char* severity) {
    const std::string place = places.at(fmt::format("dds.{}", remark.key));
    std::fputs(fmt::format("{}{}{}\n", place.empty() ? "" : place + ": ", severity,
                           fieldcast::to_text(remark))
                   .c_str(),
               stderr);
  };
  for (const auto& fault : joining.faults) print(fault, "");
  for (const auto& warning : joining.warnings) print(warning, "warning: ");
  if (spec.dds.without_security)
    std::fputs(fmt::format("warning: dds: {}\n", kOpen).c_str(), stderr);
  if (!joining.faults.empty()) return ExitCode::kBadConfiguration;
  std::puts("in order");
  return ExitCode::kOk;
}

bool log_joining(const ForwardSpec& spec) {
  const auto joining = fieldcast::check_joining(spec.dds, {}, fieldcast::read_clocks().utc);
  for (const auto& fault : joining.faults) fieldcast::log_error(fault.of, fault.text);
  for (const auto& warning : joining.warnings) fieldcast::log_warning(warning.of, warning.text);
  if (spec.dds.without_security) fieldcast::log_warning("dds", kOpen);
  return joining.faults.empty();
}

ExitCode serve(fieldcast::Signals& signals, const ForwardSpec& spec) {
  if (!log_joining(spec)) return ExitCode::kBadConfiguration;
  fieldcast::IdentityWatch identity(false);
  identity.joined(spec.dds, fieldcast::read_clocks().utc);
  Forwarder forwarder(spec);
  forwarder.start();
  std::optional<fieldcast::MetricsServer> metrics;
  if (spec.metrics)
    metrics.emplace(
        spec.metrics->listen,
        [&forwarder](fieldcast::MetricsFormat format) {
          return metrics_text(forwarder.status(), format);
        },
        [] { return std::string(); });
  fieldcast::Service service(fieldcast::notify_address(), fieldcast::watchdog_limit());
  fieldcast::log_info("forward",
                      fmt::format("forwards domain {} as site {}", spec.dds.domain, spec.site));
  service.ready(to_text(forwarder.status()));
  fieldcast::Instant kept{};
  for (;;) {
    const int signal = signals.wait(service.sleep(kHousekeeping));
    const bool removed = signal == fieldcast::Signals::kRemoved;
    const fieldcast::Instant now = fieldcast::steady_now();
    if (service.watched()) service.look(forwarder.turns(), now);
    if (now - kept >= kHousekeeping) {
      kept = now;
      fieldcast::log_summaries(now);
      forwarder.report();
      service.status(to_text(forwarder.status()));
      identity.look(fieldcast::read_clocks().utc);
    }
    if (removed) {
      fieldcast::log_error("forward", fieldcast::kEndsRemoved);
    } else if (signal != SIGTERM && signal != SIGINT) {
      if (signal != 0) fieldcast::log_info("forward", to_text(forwarder.status()));
      continue;
    } else {
      fieldcast::log_info("forward", fmt::format("stopping ({})", ::sigabbrev_np(signal)));
    }
    service.stopping();
    forwarder.stop();
    fieldcast::log_info("forward", "stopped: " + to_text(forwarder.status()));
    return removed ? ExitCode::kInternal : ExitCode::kOk;
  }
}

ExitCode run(int argc, char** argv) {
  fieldcast::CommandLine line("fieldcast-forward",
                              "Forwards the samples and alarms of a DDS domain to a message engine "
                              "or a database, by a durable queue.");
  line.set_footer(
      "Signals: SIGHUP and SIGUSR1 log the state of the queue, SIGTERM and SIGINT stop in order; "
      "the queue stays.\n"
      "Exit codes: 0 in order, 1 a fault of the program, 2 command line, 3 faults in the "
      "configuration or the identity, 4 the domain cannot be joined or the queue cannot be opened, "
      "5 a library hung during the stop.");
  std::string file;
  bool only_check = false;
  line.text("--config", file, "the configuration (YAML)").required().existing_file();
  line.flag("--check", only_check, "only report the faults of the configuration");
  if (const auto fault = line.parse_or_print(argc, argv))
    return *fault ? ExitCode::kUsage : ExitCode::kOk;
  fieldcast::Signals signals;
  fieldcast::config::Places places;
  const auto spec = load_forward(file, &places);
  if (!spec) {
    std::fputs(fieldcast::config::to_text(spec.error()).c_str(), stderr);
    return ExitCode::kBadConfiguration;
  }
  if (only_check) return check(*spec, places);
  fieldcast::open_log(spec->log.level);
  fieldcast::log_library_messages();
  ExitCode code = ExitCode::kCannotStart;
  try {
    code = serve(signals, *spec);
  } catch (const fieldcast::DdsError& error) {
    fieldcast::log_error("forward", fmt::format("cannot start: {}", error.what()));
  } catch (const fieldcast::StoreAway& error) {
    fieldcast::log_error("forward", fmt::format("cannot start: {}; free 1 MB on the disk of the "
                                                "queue, and check that it can be written",
                                                error.what()));
  } catch (const fieldcast::StoreError& error) {
    fieldcast::log_error("forward", fmt::format("cannot start: {}", error.what()));
  }
  fieldcast::flush_log(fieldcast::kLastWords);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  return fieldcast::daemon_main("forward", [&] { return run(argc, argv); });
}
