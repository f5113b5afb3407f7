#include "tools/cli/command/station/status.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "core/base/json.hpp"
#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/screen/status_screen.hpp"
#include "tools/cli/terminal/console.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/terminal/terminal.hpp"
#include "tools/cli/view/status/status_facts.hpp"
#include "tools/cli/view/status/status_view.hpp"

namespace fieldcast::cli {

namespace {

constexpr Duration kDrawStatusAgain = std::chrono::milliseconds{200};

std::string notice_of(const Connection& connection, DomainView& domain, Duration waited) {
  return waited <= kBridgeWait
             ? fmt::format("waiting for a bridge in {} ..", domain_text(connection))
             : no_bridge_text(connection, domain.missing_servers());
}

// Runs the screen until `end`, until the user quits, or until the inbox is closed. Processes keys
// immediately, and DDS events at least ten times a second. REQUIRES: no_screen_reason() is empty;
// the status is subscribed. Throws std::runtime_error.
void status_live(const Connection& connection, DomainView& domain, StatusModel& model,
                 StandbyWatch& members, Instant end) {
  StatusScreen screen(model);
  Terminal terminal;
  const auto began = instant_now();
  auto next_draw = began;
  for (auto now = began; now < end && !domain.inbox().closed(); now = instant_now()) {
    bool pressed = false;
    while (const auto key = terminal.key(pressed ? now : std::min(end, next_draw))) {
      pressed = true;
      now = instant_now();
      if (!screen.on_key(*key, {now, utc_now()})) return;
    }
    for (const auto& event : domain.inbox().take_present()) update(model, event);
    model.members = members.model();
    now = instant_now();
    if (!pressed && now < next_draw) continue;
    screen.set_notice(notice_of(connection, domain, now - began));
    terminal.draw(screen.frame({now, utc_now()}, terminal.size()));
    next_draw = now + kDrawStatusAgain;
  }
}

Json bus_json(const StatusModel& model, const StationBusStatus& bus) {
  Json line = status_json(bus);
  add_claims(line, model, bus);
  return line;
}

void print_json(const StatusModel& model, const StandbyModel& members, std::ostream& out) {
  for (const auto& [name, bus] : model.buses) out << bus_json(model, bus).text() << '\n';
  for (const auto& [key, device] : model.devices) out << status_json(device).text() << '\n';
  for (const auto& [key, member] : members) out << standby_json(member).text() << '\n';
}

void print_tables(const StatusModel& model, const StandbyModel& members, std::ostream& out) {
  const Screen screen = output_screen();
  print(out, status_lines(model, utc_now(), screen));
  if (members.empty()) return;
  out << '\n';
  print(out, standby_lines(members, screen));
}

void print_event(const StatusModel& model, const DomainEvent& event, std::ostream& out) {
  if (const auto* bus = std::get_if<StationBusStatus>(&event))
    out << bus_json(model, *bus).text() << '\n';
  if (const auto* device = std::get_if<StationDeviceStatus>(&event))
    out << status_json(*device).text() << '\n';
}

// Prints the reason if the terminal cannot show a screen.
bool screen_wanted(const StatusOptions& options, std::ostream& err) {
  if (options.once || options.plain || options.json || !output_is_terminal()) return false;
  const std::string reason = no_screen_reason();
  if (!reason.empty()) err << "fieldcast status: " << reason << ": text instead\n" << std::flush;
  return reason.empty();
}

// Returns kOk if a bus reported or Ctrl-C ended an endless screen, else kNoBridge.
ExitCode status(const StatusOptions& options, const Connection& connection, Interrupt& interrupt,
                const Streams& to) {
  DomainView domain(connection, interrupt);
  StandbyWatch members(connection);
  StatusModel model;
  const auto began = instant_now();
  domain.subscribe_status();
  if (screen_wanted(options, to.err)) {
    status_live(connection, domain, model, members, options.time ? began + *options.time : kNever);
    print_tables(model, model.members, to.out);
    if (!to.out.flush()) return ExitCode::kTrouble;
    return domain.interrupted() && options.time ? ExitCode::kInterrupted : ExitCode::kOk;
  }
  const Listening listening = receive_reports(domain, connection, options.time, to,
                                              [&](const DomainEvent& event, const Listening&) {
                                                const bool is_new = update(model, event);
                                                if (options.time && options.json)
                                                  print_event(model, event, to.out);
                                                return is_new;
                                              });
  if (domain.interrupted() && (!options.time || model.buses.empty())) return ExitCode::kInterrupted;
  if (const auto code =
          no_reports("status", domain, connection, listening, !model.buses.empty(), to.err))
    return *code;
  if (!options.json) {
    print_tables(model, members.model(), to.out);
  } else if (!options.time) {
    print_json(model, members.model(), to.out);
  }
  if (!to.out.flush()) return ExitCode::kTrouble;
  return domain.interrupted() ? ExitCode::kInterrupted : ExitCode::kOk;
}

void describe_status(CommandLine& line, StatusOptions& options) {
  line.flag("--once", options.once,
            "Each bus and device once as text, then end: the default where the "
            "output is no terminal");
  line.flag("--plain", options.plain, "The same, with --for what it is at the end");
  line.duration("--for", options.time, CommandLine::kShortest, "Follow it for this time (20, 2min)")
      .excludes("--once");
  line.flag("--json", options.json, "JSON lines");
  add_connection(line, options.connection);
}

}  // namespace

CommandRow status_command() {
  return command_row("status",
                     "Show buses and devices: state, load, learned times, failures by cause",
                     describe_status, [](const StatusOptions& options, const Streams& to) {
                       use_terminal_locale();  // before DDS starts its threads
                       return in_domain(status)(options, to);
                     });
}

}  // namespace fieldcast::cli
