#include "tools/cli/command/station/sessions.hpp"

#include <ostream>

#include "tools/cli/command/base/command.hpp"
#include "tools/cli/command/base/in_domain.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/domain/listening.hpp"
#include "tools/cli/terminal/clock.hpp"
#include "tools/cli/terminal/console.hpp"
#include "tools/cli/view/sessions_view.hpp"

namespace fieldcast::cli {
ExitCode sessions(const SessionsOptions& options, const Connection& connection,
                  Interrupt& interrupt, std::ostream& out, std::ostream& err) {
  DomainView domain(connection, interrupt);
  SessionsModel model;
  const auto began = instant_now();
  Listening listening(connection, began);
  const auto end = began + options.time.value_or(kBridgeWait);
  domain.subscribe_program_sessions();

  for (auto now = began; now < end && !domain.inbox().closed() && out; now = instant_now()) {
    if (!options.time && now >= listening.over_at()) break;
    const auto wake = options.time ? end : std::min(end, listening.over_at());
    for (const auto& event : domain.inbox().take_all(to_steady(wake))) {
      if (!listening.heard_site_of(bus_of(event)) ||
          std::holds_alternative<ProgramSessionReport>(event))
        listening.news(bus_of(event), instant_now());
      const auto* report = std::get_if<ProgramSessionReport>(&event);
      if (report == nullptr) continue;
      model.insert_or_assign({report->bus, report->device}, *report);
      if (options.time && options.json) out << session_json(*report).text() << '\n';
      if (options.time && !options.json) {
        for (const auto& line :
             sessions_lines({{{report->bus, report->device}, *report}}, utc_now(), {}))
          out << line << '\n';
      }
    }
    out.flush();
  }
  if (domain.interrupted() && !options.time) return ExitCode::kInterrupted;
  if (!listening.anybody()) {
    err << "fieldcast sessions: " << no_bridge_text(connection, domain.missing_servers()) << '\n';
    return ExitCode::kNoBridge;
  }
  if (const std::string silent = listening.silent_text(); !silent.empty())
    err << "fieldcast sessions: " << silent << '\n';
  if (!options.time && options.json) {
    for (const auto& [key, report] : model) out << session_json(report).text() << '\n';
  } else if (!options.time) {
    for (const auto& line : sessions_lines(model, utc_now(), {0, 0, output_screen().colour}))
      out << line << '\n';
  }
  out.flush();
  return out ? ExitCode::kOk : ExitCode::kTrouble;
}

namespace {

class SessionsCommand final : public CommandWith<SessionsOptions> {
 public:
  void describe(CommandLine& line) override {
    line.duration("--for", options_.time, CommandLine::kShortest,
                  "Follow them for this time (20, 2min), a line for each report");
    line.flag("--json", options_.json, "JSON lines");
    add_connection(line, options_.connection);
  }
  ExitCode run(const Streams& streams) override {
    return in_domain(options_.connection, streams,
                     [&](const Connection& connection, Interrupt& interrupt) {
                       return sessions(options_, connection, interrupt, streams.out, streams.err);
                     });
  }
};

}  // namespace

CommandEntry sessions_command();
CommandEntry sessions_command() {
  return {"sessions", "Show who programs which device through a bridge",
          make_command<SessionsCommand>};
}

}  // namespace fieldcast::cli
