#include "tools/cli/command/station/standby.hpp"

#include <fmt/format.h>

#include <functional>
#include <optional>
#include <ostream>

#include "tools/cli/command/base/command.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/terminal/console.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/station_view.hpp"
#include "tools/cli/view/status/status_facts.hpp"

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

namespace {

constexpr Duration kRequestLimit = std::chrono::seconds{3};
constexpr Duration kTakeLimit = std::chrono::seconds{5};
using GiveUp = std::function<bool()>;

// The bridge `wanted`, or for a group its strongest ready waiting bridge, empty if there is none. A
// late request without a bridge name would also be obeyed by the new master.
std::optional<StandbyRequest> request_for(const StandbyModel& model, const std::string& wanted) {
  for (const auto& [key, member] : model) {
    if (key.second == wanted) return StandbyRequest{key.first, wanted, "fieldcast standby"};
  }
  const StandbyMember* best = nullptr;
  bool is_group = false;
  for (const auto& [key, message] : model) {
    if (key.first != wanted) continue;
    is_group = true;
    const StandbyMember& member = message.member;
    if (member.role != StandbyRole::kWaiting || !member.not_ready.empty()) continue;
    if (best == nullptr || member.strength > best->strength) best = &member;  // ties: by name
  }
  if (!is_group) return std::nullopt;
  return StandbyRequest{wanted, best == nullptr ? "" : best->bridge, "fieldcast standby"};
}

const StandbyMessage* master_of(const StandbyModel& model, const std::string& group) {
  for (const auto& [key, member] : model) {
    if (key.first == group && member.member.role == StandbyRole::kMaster) return &member;
  }
  return nullptr;
}

ExitCode take(const StandbyOptions& options, StandbyWatch& members, const GiveUp& give_up,
              std::ostream& out, std::ostream& err) {
  const StandbyModel before = members.model();
  const auto request = request_for(before, options.wanted);
  if (!request) {
    err << fmt::format("fieldcast standby: no bridge and no group is called '{}'\n",
                       options.wanted);
    return ExitCode::kNothing;
  }
  const StandbyMessage* const master = master_of(before, request->group);
  const std::string old = master == nullptr ? "" : master->member.bridge;
  if (!request->bridge.empty() && old == request->bridge) {
    out << fmt::format("{} is master already\n", old);
    return ExitCode::kOk;
  }
  if (request->bridge.empty()) {
    err << fmt::format("fieldcast standby: no other bridge of group {} is ready\n", request->group);
    return ExitCode::kRejected;
  }
  const auto target = before.find({request->group, request->bridge});
  if (target != before.end() && !target->second.member.not_ready.empty()) {
    err << fmt::format("fieldcast standby: {} is not ready: {}\n", request->bridge,
                       target->second.member.not_ready);
    return ExitCode::kRejected;
  }
  std::string now;
  const auto taken = [&](const StandbyModel& model) {
    const StandbyMessage* const found = master_of(model, request->group);
    now = found == nullptr ? "" : found->member.bridge;
    return !now.empty() && now != old && (request->bridge.empty() || now == request->bridge);
  };
  if (!members.request(*request, kRequestLimit) ||
      !members.until(taken, instant_now() + kTakeLimit, give_up)) {
    err << fmt::format("fieldcast standby: {} did not hand over; its log says why\n",
                       old.empty() ? "the group has no master, and" : old);
    return ExitCode::kNoAnswer;
  }
  out << fmt::format("{} is master of group {}\n", now, request->group);
  return ExitCode::kOk;
}

}  // namespace

ExitCode standby(const StandbyOptions& options, const Connection& connection, Interrupt& interrupt,
                 std::ostream& out, std::ostream& err) {
  StandbyWatch members(connection);
  const GiveUp give_up = [&interrupt] { return interrupt.raised(); };
  const auto is_there = [](const StandbyModel& model) { return !model.empty(); };
  // By then all other members have probably reported.
  if (members.until(is_there, instant_now() + kBridgeWait, give_up)) {
    const auto never = [](const StandbyModel&) { return false; };
    (void)members.until(never, instant_now() + kQuietTime, give_up);
  }
  const StandbyModel model = members.model();
  if (interrupt.raised()) return ExitCode::kInterrupted;
  if (model.empty()) {
    err << "fieldcast standby: no bridge of a standby group is in " << domain_text(connection)
        << '\n';
    return ExitCode::kNoBridge;
  }
  if (options.take) return take(options, members, give_up, out, err);
  if (options.json) {
    for (const auto& [key, member] : model) out << standby_json(member).text() << '\n';
  } else {
    for (const auto& line : standby_lines(model, {})) out << line << '\n';
  }
  out.flush();
  return out ? ExitCode::kOk : ExitCode::kTrouble;
}

namespace {

class StandbyCommand final : public CommandWith<StandbyOptions> {
 public:
  void describe(CommandLine& line) override {
    CommandLine& taking = line.command("take", "Make another bridge the master");
    taking
        .text("NAME", options_.wanted,
              "The bridge that is to be master, or a group: then its strongest that is ready")
        .required();
    add_connection(taking, options_.connection);
    taking.when_given([this]() -> std::optional<CommandLine::Fault> {
      options_.take = true;
      return std::nullopt;
    });
    line.make_commands_optional();
    line.flag("--json", options_.json, "JSON lines");
    add_connection(line, options_.connection);
  }
  ExitCode run(const Streams& streams) override {
    return in_domain(options_.connection, streams,
                     [&](const Connection& connection, Interrupt& interrupt) {
                       return standby(options_, connection, interrupt, streams.out, streams.err);
                     });
  }
};

}  // namespace

CommandEntry standby_command();
CommandEntry standby_command() {
  return {"standby",
          "Show which bridge of a standby group is master; take: make another member master",
          make_command<StandbyCommand>};
}

}  // namespace fieldcast::cli
