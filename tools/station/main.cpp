// fieldcast-station: shows a DDS domain as a web page.
#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/base/exit_code.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/dds/transport/join_check.hpp"
#include "bridge/log/log.hpp"
#include "bridge/process/command_line.hpp"
#include "bridge/process/secret.hpp"
#include "bridge/service/library_log.hpp"
#include "bridge/service/process_watch.hpp"
#include "bridge/service/service.hpp"
#include "tools/station/notify/delivery.hpp"
#include "tools/station/notify/message_text.hpp"
#include "tools/station/settings/configuration.hpp"
#include "tools/station/station.hpp"

namespace {

using fieldcast::ExitCode;
using namespace fieldcast::web;

constexpr fieldcast::Duration kHousekeeping = std::chrono::seconds{10};
constexpr const char* kOpen = "security: none: every program in the network can read and command";

struct Options {
  std::string config;
  std::optional<fieldcast::ListenSpec> listen;
  std::optional<std::uint32_t> domain;
  std::vector<std::string> interfaces;
  std::string security;
  bool check = false;
  std::string notify_test;
};

std::optional<StationSpec> spec_of(const Options& options, fieldcast::config::Places& places) {
  StationSpec spec;
  if (!options.config.empty()) {
    auto loaded = load_station(options.config, options.listen, &places);
    if (!loaded) {
      std::fputs(fieldcast::config::to_text(loaded.error()).c_str(), stderr);
      return std::nullopt;
    }
    spec = *std::move(loaded);
  } else if (options.listen) {
    spec.web.listen = *options.listen;
    const auto exposures = exposures_of(spec);
    for (const Exposure& each : exposures)
      std::fputs(fmt::format("--listen: {}; allowed: {}, in a file that --config names\n",
                             each.what, each.mend)
                     .c_str(),
                 stderr);
    if (!exposures.empty()) return std::nullopt;
  }
  const bool of_dds = options.domain || !options.interfaces.empty() || !options.security.empty();
  if (of_dds && spec.sites.size() != 1) {
    std::fputs(
        spec.sites.empty()
            ? "--domain, --interface, --security: the file has no 'dds' and only a 'stream'\n"
            : "--domain, --interface, --security: each of several sites says its own in the "
              "file\n",
        stderr);
    return std::nullopt;
  }
  if (options.domain) spec.sites.front().dds.domain = *options.domain;
  if (!options.interfaces.empty()) spec.sites.front().dds.interfaces = options.interfaces;
  if (!options.security.empty()) spec.sites.front().dds.security = options.security;
  return spec;
}

class Origin {
 public:
  Origin(const Options& options, const fieldcast::config::Places& places)
      : options_(options), places_(places) {}
  // `site`: index in `sites`.
  [[nodiscard]] std::string of_dds(const StationSpec& spec, std::size_t site,
                                   const std::string& key) const {
    if (key == "security" && !options_.security.empty()) return "--security: ";
    const bool several = !spec.sites[site].name.empty();
    return of(several ? fmt::format("sites.{}.dds.{}", site, key) : "dds." + key);
  }
  [[nodiscard]] std::string of(const std::string& path) const {
    const std::string place = places_.at(path);
    return place.empty() ? "" : place + ": ";
  }

 private:
  const Options& options_;
  const fieldcast::config::Places& places_;
};

ExitCode check_joining(const StationSpec& spec, const Origin& origin) {
  bool good = true;
  for (std::size_t i = 0; i < spec.sites.size(); ++i) {
    const fieldcast::DdsSite& site = spec.sites[i];
    const auto check = fieldcast::check_joining(site.dds, {}, fieldcast::read_clocks().utc);
    const std::string name = site.name.empty() ? "" : site.name + ": ";
    const auto say = [&](const fieldcast::JoinRemark& remark, const char* severity) {
      std::fputs(fmt::format("{}{}{}{}\n", origin.of_dds(spec, i, remark.key), severity, name,
                             fieldcast::to_text(remark))
                     .c_str(),
                 stderr);
    };
    for (const fieldcast::JoinRemark& fault : check.faults) say(fault, "");
    for (const fieldcast::JoinRemark& warning : check.warnings) say(warning, "warning: ");
    good = good && check.faults.empty();
  }
  return good ? ExitCode::kOk : ExitCode::kBadConfiguration;
}

void on_hangup(WebStation& station) {
  if (const auto renewed = station.renew_certificate(); !renewed)
    return fieldcast::log_error("web", "the old certificate goes on: " + renewed.error());
  fieldcast::log_info("web", "certificate and key are read from their files again");
}

class SiteIdentities {
 public:
  explicit SiteIdentities(const StationSpec& spec)
      : each_(spec.sites.size(), fieldcast::IdentityWatch(false)) {
    for (std::size_t i = 0; i < each_.size(); ++i)
      each_[i].joined(spec.sites[i].dds, fieldcast::read_clocks().utc);
  }
  void look() {
    for (fieldcast::IdentityWatch& each : each_) each.look(fieldcast::read_clocks().utc);
  }

 private:
  std::vector<fieldcast::IdentityWatch> each_;
};

bool log_joining(const StationSpec& spec) {
  bool good = true;
  for (const fieldcast::DdsSite& site : spec.sites) {
    const auto check = fieldcast::check_joining(site.dds, {}, fieldcast::read_clocks().utc);
    for (const auto& fault : check.faults) fieldcast::log_error(fault.of, fault.text);
    for (const auto& warning : check.warnings) fieldcast::log_warning(warning.of, warning.text);
    if (site.dds.without_security) fieldcast::log_warning("dds", kOpen);
    good = good && check.faults.empty();
  }
  return good;
}

ExitCode serve(fieldcast::Signals& signals, const StationSpec& spec) {
  if (!log_joining(spec)) {
    fieldcast::log_error("web", "cannot start: what it joins with is not in order");
    return ExitCode::kBadConfiguration;
  }
  SiteIdentities identities(spec);
  WebStation station(spec, FIELDCAST_VERSION);
  const auto watched = signals.if_stuck([&station] {
    fieldcast::log_error(
        "web", fmt::format("not stopped in time, while {}: the process ends", station.busy_with()));
    fieldcast::flush_log(fieldcast::kLastWords);
  });
  if (const auto started = station.start(); !started) {
    fieldcast::log_error("web", "cannot start: " + started.error().what);
    return started.error().configuration ? ExitCode::kBadConfiguration : ExitCode::kCannotStart;
  }
  const std::string status = "served at " + station.address();
  fieldcast::log_info("web", status);
  fieldcast::Service service(fieldcast::notify_address(), fieldcast::watchdog_limit());
  service.ready(status);
  for (;;) {
    if (service.watched()) service.look(station.turns(), fieldcast::steady_now());
    const int signal = signals.wait(service.sleep(kHousekeeping));
    const bool removed = signal == fieldcast::Signals::kRemoved;
    if (removed) {
      fieldcast::log_error("web", fieldcast::kEndsRemoved);
    } else if (signal == 0) {
      fieldcast::log_summaries(fieldcast::steady_now());
      identities.look();
      continue;
    } else if (signal == SIGHUP) {
      service.reloading(fieldcast::steady_now());
      on_hangup(station);
      service.ready(status);
      continue;
    } else if (signal == SIGUSR1) {
      continue;
    } else {
      fieldcast::log_info("web", fmt::format("stopping ({})", ::sigabbrev_np(signal)));
    }
    service.stopping();
    station.stop();
    fieldcast::log_info("web", "stopped");
    return removed ? ExitCode::kInternal : ExitCode::kOk;
  }
}

// Checks that the key file is not readable by others; the loader has checked the rest.
ExitCode check_key(const StationSpec& spec, const Origin& origin) {
  if (spec.web.key.empty()) return ExitCode::kOk;
  const auto closed =
      fieldcast::check_secret_file(spec.web.key, fieldcast::Readers::kOwnerAndGroup);
  if (closed) return ExitCode::kOk;
  std::fputs(fmt::format("{}web: {}\n", origin.of("web.key"), closed.error()).c_str(), stderr);
  return ExitCode::kBadConfiguration;
}

ExitCode check_notify(const StationSpec& spec, const Origin& origin) {
  if (!spec.notify) return ExitCode::kOk;
  const auto readable = check_files(*spec.notify);
  if (readable) return ExitCode::kOk;
  std::fputs(fmt::format("{}notify: {}\n", origin.of("notify"), readable.error()).c_str(), stderr);
  return ExitCode::kBadConfiguration;
}

// Sends a test to the first recipient of a target, without the queue.
ExitCode test_notify(const StationSpec& spec, const std::string& name) {
  const auto& targets = spec.notify ? spec.notify->targets : std::vector<NotifyTarget>{};
  const auto target = std::find_if(targets.begin(), targets.end(),
                                   [&](const NotifyTarget& each) { return each.name == name; });
  if (target == targets.end()) {
    std::fputs(fmt::format("--notify-test: '{}' is not a target of 'notify'\n", name).c_str(),
               stderr);
    return ExitCode::kUsage;
  }
  const auto sent = deliver(spec.notify->mail, *target,
                            test_row(*target, spec.name, fieldcast::read_clocks().utc));
  if (sent) {
    std::puts("the server has accepted the message");
    return ExitCode::kOk;
  }
  std::fputs(fmt::format("{}: {}\n", name, sent.error()).c_str(), stderr);
  return ExitCode::kCannotStart;
}

// Also prints successful checks, so that an empty output is never a success.
ExitCode check(const StationSpec& spec, const Origin& origin) {
  const ExitCode joining = check_joining(spec, origin), key = check_key(spec, origin);
  const ExitCode notify = check_notify(spec, origin);
  for (const fieldcast::DdsSite& site : spec.sites) {
    if (site.dds.without_security)
      std::fputs(
          fmt::format("warning: {}dds: {}\n", site.name.empty() ? "" : site.name + ": ", kOpen)
              .c_str(),
          stderr);
  }
  if (joining != ExitCode::kOk) return joining;
  if (key != ExitCode::kOk) return key;
  if (notify == ExitCode::kOk) std::puts("in order");
  return notify;
}

ExitCode run(int argc, char** argv) {
  fieldcast::CommandLine line("fieldcast-station",
                              "Shows what bridges publish on DDS as a web page.");
  line.set_footer(
      "Without a configuration the page is at http://127.0.0.1:8090/, for this machine only.\n"
      "Signals: SIGHUP reads certificate and key from their files again, SIGTERM and SIGINT stop "
      "in "
      "order.\n"
      "Exit codes: 0 in order, 1 a fault of the program, 2 command line, 3 faults in the "
      "configuration or the identity, 4 the domain cannot be joined or the address is taken, 5 a "
      "library hung "
      "during the stop.");
  Options options;
  line.text("--config", options.config, "the configuration (YAML)").existing_file();
  line.value(
      "--listen",
      [&options](const std::string& text) -> std::optional<std::string> {
        options.listen = listen_from(text);
        if (options.listen) return std::nullopt;
        return "'" + text + "' is no address and port, such as 127.0.0.1:8090";
      },
      "ADDRESS:PORT of the page, instead of the configuration's");
  line.number("--domain", options.domain, 0, 232, "DDS domain, instead of the configuration's");
  line.texts("--interface", options.interfaces,
             "IPv4 address that DDS may use, instead of the configuration's; may be repeated");
  line.value(
      "--security",
      [&options](const std::string& text) -> std::optional<std::string> {
        if (text.empty()) return "is empty; name the folder of a member, or leave it out";
        options.security = text;
        return std::nullopt;
      },
      "join as the member whose folder this is (fieldcast secure add), instead of the "
      "configuration's");
  line.flag("--check", options.check, "only report the faults of the configuration");
  line.text("--notify-test", options.notify_test,
            "only send a test message to this target of 'notify'");
  if (const auto fault = line.parse_or_print(argc, argv))
    return *fault ? ExitCode::kUsage : ExitCode::kOk;
  fieldcast::Signals signals;
  fieldcast::config::Places places;
  const auto spec = spec_of(options, places);
  if (!spec) return ExitCode::kBadConfiguration;
  if (options.check) return check(*spec, Origin(options, places));
  if (!options.notify_test.empty()) return test_notify(*spec, options.notify_test);
  fieldcast::open_log(spec->log.level);
  fieldcast::log_library_messages();
  ExitCode code = ExitCode::kCannotStart;
  try {
    code = serve(signals, *spec);
  } catch (const fieldcast::DdsError& error) {
    fieldcast::log_error("web", fmt::format("cannot start: {}", error.what()));
  }
  fieldcast::flush_log(fieldcast::kLastWords);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  return fieldcast::daemon_main("web", [&] { return run(argc, argv); });
}
