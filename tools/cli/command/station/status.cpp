#include "tools/cli/command/station/status.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <ostream>

#include "core/base/json.hpp"
#include "tools/cli/command/base/command.hpp"
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

constexpr Duration kLook = std::chrono::milliseconds{500};

Json bus_json(const StatusModel& model, const StationBusStatus& bus) {
  Json line = status_json(bus);
  add_claims(line, model, bus);
  return line;
}

void print_json(const StatusModel& model, std::ostream& out) {
  for (const auto& [name, bus] : model.buses) out << bus_json(model, bus).text() << '\n';
  for (const auto& [key, device] : model.devices) out << status_json(device).text() << '\n';
}

void print_table(const StatusModel& model, std::ostream& out) {
  const Screen screen = output_screen();
  for (const auto& line : status_lines(model, utc_now(), screen)) out << line << '\n';
}

void print_members(const StandbyModel& model, std::ostream& out) {
  if (model.empty()) return;
  out << '\n';
  for (const auto& line : standby_lines(model, output_screen())) out << line << '\n';
}

void print_event(const StatusModel& model, const DomainEvent& event, std::ostream& out) {
  if (const auto* bus = std::get_if<StationBusStatus>(&event))
    out << bus_json(model, *bus).text() << '\n';
  if (const auto* device = std::get_if<StationDeviceStatus>(&event))
    out << status_json(*device).text() << '\n';
}

// Prints the reason if the terminal cannot show a screen.
bool screen_wanted(const StatusOptions& options, std::ostream& err) {
  if (!options.screen || options.json || !output_is_terminal()) return false;
  const std::string reason = no_screen_reason();
  if (!reason.empty()) err << "fieldcast status: " << reason << ": text instead\n" << std::flush;
  return reason.empty();
}

}  // namespace

ExitCode status(const StatusOptions& options, const Connection& connection, Interrupt& interrupt,
                std::ostream& out, std::ostream& err) {
  DomainView domain(connection, interrupt);
  StandbyWatch members(connection);
  StatusModel model;
  const auto began = instant_now();
  domain.subscribe_status();
  if (screen_wanted(options, err)) {
    status_live(connection, domain, model, members, options.time ? began + *options.time : kNever);
    print_table(model, out);
    print_members(model.members, out);
    return out.flush() ? ExitCode::kOk : ExitCode::kTrouble;
  }

  const auto end = began + options.time.value_or(kBridgeWait);
  Listening listening(connection, began);
  for (auto now = began; now < end && !domain.inbox().closed() && out; now = instant_now()) {
    if (!options.time && now >= listening.over_at()) break;
    const auto wake = options.time ? now + kLook : listening.over_at();
    for (const auto& event : domain.inbox().take_all(to_steady(std::min(end, wake)))) {
      if (update(model, event)) listening.news(bus_of(event), instant_now());
      if (options.time && options.json) print_event(model, event, out);
    }
    out.flush();
  }
  if (domain.interrupted() && !options.time) return ExitCode::kInterrupted;
  if (model.buses.empty()) {
    err << "fieldcast status: " << no_bridge_text(connection, domain.missing_servers()) << '\n';
    return ExitCode::kNoBridge;
  }
  if (const std::string silent = listening.silent_text(); !silent.empty())
    err << "fieldcast status: " << silent << '\n';
  if (!options.json) {
    print_table(model, out);
    print_members(members.model(), out);
  } else if (!options.time) {
    print_json(model, out);
    for (const auto& [key, member] : members.model()) out << standby_json(member).text() << '\n';
  }
  out.flush();
  return out ? ExitCode::kOk : ExitCode::kTrouble;
}

namespace {

class StatusCommand final : public CommandWith<StatusOptions> {
 public:
  void describe(CommandLine& line) override {
    line.flag("--once", once_,
              "Each bus and device once as text, then end: the default where the "
              "output is no terminal");
    line.flag("--plain", plain_, "The same, with --for what it is at the end");
    line.duration("--for", options_.time, CommandLine::kShortest,
                  "Follow it for this time (20, 2min)")
        .excludes("--once");
    line.flag("--json", options_.json, "JSON lines");
    add_connection(line, options_.connection);
  }
  ExitCode run(const Streams& streams) override {
    options_.screen = !once_ && !plain_;
    use_terminal_locale();
    return in_domain(options_.connection, streams,
                     [&](const Connection& connection, Interrupt& interrupt) {
                       return status(options_, connection, interrupt, streams.out, streams.err);
                     });
  }

 private:
  bool once_ = false, plain_ = false;
};

}  // namespace

CommandEntry status_command();
CommandEntry status_command() {
  return {"status", "Show buses and devices: state, load, learned times, failures by cause",
          make_command<StatusCommand>};
}

namespace {

constexpr Duration kDrawStatusAgain = std::chrono::milliseconds{200};

std::string notice_of(const Connection& connection, DomainView& domain, Duration waited) {
  return waited <= kBridgeWait
             ? fmt::format("waiting for a bridge in {} ..", domain_text(connection))
             : no_bridge_text(connection, domain.missing_servers());
}

}  // namespace

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

}  // namespace fieldcast::cli
