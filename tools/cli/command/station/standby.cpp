#include <fmt/format.h>

#include <functional>
#include <optional>
#include <ostream>
#include <string>

#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/station_view.hpp"
#include "tools/cli/view/status/status_facts.hpp"

namespace fieldcast::cli {
namespace {

struct SessionsOptions {
  ConnectionOptions connection;
  bool json = false;
  // follows them for this time, one line for each report; empty: print once
  std::optional<Duration> time;
};

void print_sessions(const SessionsModel& model, bool json, const Streams& to,
                    const Screen& screen) {
  if (!json) return print(to.out, sessions_lines(model, utc_now(), screen));
  for (const auto& [key, report] : model) to.out << session_json(report).text() << '\n';
}

// Returns kOk if a bridge reported, with or without sessions, else kNoBridge.
ExitCode sessions(const SessionsOptions& options, const Connection& connection,
                  Interrupt& interrupt, const Streams& to) {
  DomainView domain(connection, interrupt);
  SessionsModel model;
  domain.subscribe_program_sessions();
  const auto on_event = [&](const DomainEvent& event, const Listening& listening) {
    const auto* report = std::get_if<ProgramSessionReport>(&event);
    if (report == nullptr) return !listening.heard_site_of(bus_of(event));
    const SessionsModel one{{{report->bus, report->device}, *report}};
    model.insert_or_assign(one.begin()->first, *report);
    if (options.time) print_sessions(one, options.json, to, {});
    return true;
  };
  const Listening listening = receive_reports(domain, connection, options.time, to, on_event);
  if (domain.interrupted()) return ExitCode::kInterrupted;
  if (const auto code =
          no_reports("sessions", domain, connection, listening, listening.anybody(), to.err))
    return *code;
  if (!options.time) print_sessions(model, options.json, to, to.wide_screen());
  to.out.flush();
  return to.out ? ExitCode::kOk : ExitCode::kTrouble;
}

void describe_sessions(CommandLine& line, SessionsOptions& options) {
  line.duration("--for", options.time, CommandLine::kShortest,
                "Follow them for this time (20, 2min), a line for each report");
  line.flag("--json", options.json, "JSON lines");
  add_connection(line, options.connection);
}

}  // namespace

CommandRow sessions_command() {
  return command_row("sessions", "Show who programs which device through a bridge",
                     describe_sessions, in_domain(sessions));
}

namespace {

struct StandbyOptions {
  ConnectionOptions connection;
  bool json = false;
  bool take = false;
  std::string wanted;  // for `take`: a bridge, or a group, whose best waiting bridge takes over
};

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
              const Streams& to) {
  const StandbyModel before = members.model();
  const auto request = request_for(before, options.wanted);
  if (!request) {
    to.err << fmt::format("fieldcast standby: no bridge and no group is called '{}'\n",
                          options.wanted);
    return ExitCode::kNothing;
  }
  const StandbyMessage* const master = master_of(before, request->group);
  const std::string old = master == nullptr ? "" : master->member.bridge;
  if (!request->bridge.empty() && old == request->bridge) {
    to.out << fmt::format("{} is master already\n", old);
    return ExitCode::kOk;
  }
  if (request->bridge.empty()) {
    to.err << fmt::format("fieldcast standby: no other bridge of group {} is ready\n",
                          request->group);
    return ExitCode::kRejected;
  }
  const auto target = before.find({request->group, request->bridge});
  if (target != before.end() && !target->second.member.not_ready.empty()) {
    to.err << fmt::format("fieldcast standby: {} is not ready: {}\n", request->bridge,
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
    if (give_up()) return ExitCode::kInterrupted;
    to.err << fmt::format("fieldcast standby: {} did not hand over; its log says why\n",
                          old.empty() ? "the group has no master, and" : old);
    return ExitCode::kNoResponse;
  }
  to.out << fmt::format("{} is master of group {}\n", now, request->group);
  return ExitCode::kOk;
}

// Returns kNoBridge if no member reported. For `take`: returns kNothing for an unknown name,
// kRejected if it is not ready, kNoResponse if nothing changed.
ExitCode standby(const StandbyOptions& options, const Connection& connection, Interrupt& interrupt,
                 const Streams& to) {
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
    to.err << "fieldcast standby: no bridge of a standby group is in " << domain_text(connection)
           << '\n';
    return ExitCode::kNoBridge;
  }
  if (options.take) return take(options, members, give_up, to);
  if (options.json) {
    for (const auto& [key, member] : model) to.out << standby_json(member).text() << '\n';
  } else {
    print(to.out, standby_lines(model, {}));
  }
  to.out.flush();
  return to.out ? ExitCode::kOk : ExitCode::kTrouble;
}

void describe_standby(CommandLine& line, StandbyOptions& options) {
  CommandLine& taking = line.command("take", "Make another bridge the master");
  taking
      .text("NAME", options.wanted,
            "The bridge that is to be master, or a group: then its strongest that is ready")
      .required();
  add_connection(taking, options.connection);
  set_when_given(taking, options.take, true);
  line.make_commands_optional();
  line.flag("--json", options.json, "JSON lines");
  add_connection(line, options.connection);
}

}  // namespace

CommandRow standby_command() {
  return command_row(
      "standby", "Show which bridge of a standby group is master; take: make another member master",
      describe_standby, in_domain(standby));
}

}  // namespace fieldcast::cli
