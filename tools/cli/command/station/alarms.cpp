#include "tools/cli/command/station/alarms.hpp"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ostream>

#include "bridge/store/alarm_life_table.hpp"
#include "tools/cli/command/base/command.hpp"
#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/terminal/console.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/station_view.hpp"

namespace fieldcast::cli {
namespace {

AlarmKey key_of(const StationAlarm& alarm) {
  return {alarm.bus, alarm.device, alarm.channel, alarm.limit};
}

struct Told {
  KnownAlarms alarms;
  Listening listening;

  // Returns true if the event is new.
  bool note(const DomainEvent& event) {
    if (const auto* bus = std::get_if<StationBusStatus>(&event))
      return !listening.heard_site_of(bus->bus);
    if (const auto* gone = std::get_if<AlarmGone>(&event)) alarms[key_of(gone->last)].alarm = {};
    if (const auto* gone = std::get_if<AlarmStatusGone>(&event))
      alarms[gone->last.alarm].status = {};
    if (const auto* alarm = std::get_if<StationAlarm>(&event))
      return !std::exchange(alarms[key_of(*alarm)].alarm, *alarm);
    if (const auto* known = std::get_if<StationAlarmStatus>(&event))
      return !std::exchange(alarms[known->alarm].status, known->status);
    return false;
  }
};

Told listen(DomainView& domain, const Connection& connection) {
  domain.subscribe_alarms();
  domain.subscribe_status();  // a bus without alarms still reports its status
  const auto began = instant_now();
  Told told{{}, {connection, began}};
  const auto end = began + kBridgeWait;
  for (auto now = began; now < std::min(end, told.listening.over_at()) && !domain.inbox().closed();
       now = instant_now()) {
    const auto until = to_steady(std::min(end, told.listening.over_at()));
    for (const auto& event : domain.inbox().take_all(until)) {
      if (told.note(event)) told.listening.news(bus_of(event), instant_now());
    }
  }
  std::erase_if(told.alarms,
                [](const auto& entry) { return !entry.second.alarm && !entry.second.status; });
  return told;
}

// Empty if a bridge reported.
std::optional<ExitCode> trouble(const DomainView& domain, const Told& told,
                                const Connection& connection, std::ostream& err) {
  if (domain.interrupted()) return ExitCode::kInterrupted;
  if (const std::string silent = told.listening.silent_text();
      told.listening.anybody() && !silent.empty())
    err << "fieldcast alarms: " << silent << '\n';
  if (told.listening.anybody()) return std::nullopt;
  err << "fieldcast alarms: " << no_bridge_text(connection, domain.missing_servers()) << '\n';
  return ExitCode::kNoBridge;
}

}  // namespace

ExitCode alarms(const AlarmsOptions& options, const Connection& connection, Interrupt& interrupt,
                std::ostream& out, std::ostream& err) {
  DomainView domain(connection, interrupt);
  const Told told = listen(domain, connection);
  if (const auto code = trouble(domain, told, connection, err)) return *code;
  if (options.json) {
    for (const auto& [key, known] : told.alarms) out << alarm_json(key, known).text() << '\n';
  } else {
    const auto lines = alarm_lines(told.alarms, utc_now(), {0, 0, output_screen().colour});
    if (lines.size() > 1) {  // more than the titles
      for (const auto& line : lines) out << line << '\n';
    }
    const bool active = std::any_of(told.alarms.begin(), told.alarms.end(),
                                    [](const auto& entry) { return entry.second.active(); });
    if (!active) out << "no alarm is active\n";
  }
  out.flush();
  return out ? ExitCode::kOk : ExitCode::kTrouble;
}

namespace {

bool is_meant(const AlarmsOptions& options, const AlarmKey& key, const AlarmStatus& status) {
  if (!options.pattern.matches(key.bus, key.device, key.channel)) return false;
  if (options.limit && key.limit != *options.limit) return false;
  const bool away = status.shelved.is_set() || status.suppressed.is_set();
  switch (*options.action) {
    case AlarmActionKind::kAcknowledge:
      return !away &&
             (status.stage == AlarmStage::kUnacknowledged || status.stage == AlarmStage::kReturned);
    case AlarmActionKind::kShelve: return status.stage != AlarmStage::kClear || away;
    case AlarmActionKind::kUnshelve: return status.shelved.is_set();
    case AlarmActionKind::kMaintenance:
    case AlarmActionKind::kEndMaintenance: break;
  }
  return false;
}

std::vector<AlarmAction> actions_of(const AlarmsOptions& options, const std::string& by,
                                    const KnownAlarms& alarms) {
  AlarmAction action;
  action.kind = *options.action;
  action.by = by;
  action.note = options.note;
  action.duration = options.duration;
  std::vector<AlarmAction> actions;
  if (is_of_device(action.kind)) {
    const std::string path = options.pattern.text();  // BUS/DEVICE/*
    const std::size_t slash = path.find('/');
    action.alarm.bus = path.substr(0, slash);
    action.alarm.device = path.substr(slash + 1, path.rfind('/') - slash - 1);
    actions.push_back(action);
    return actions;
  }
  for (const auto& [key, known] : alarms) {
    if (!known.status || !is_meant(options, key, *known.status)) continue;
    action.alarm = key;
    // Acknowledges the state that the user saw, not a newer one.
    if (action.kind == AlarmActionKind::kAcknowledge) action.raised_at = known.status->raised_at;
    actions.push_back(action);
  }
  return actions;
}

ExitCode code_of(const StationOutcome& outcome) {
  if (!outcome)
    return outcome.error() == StationFault::kNoBridge ? ExitCode::kNoBridge : ExitCode::kNoAnswer;
  switch (outcome->state) {
    case CommandState::kDone:
    case CommandState::kVerified: return ExitCode::kOk;
    case CommandState::kRejected: return ExitCode::kRejected;
    case CommandState::kFailed: return ExitCode::kFailed;
    case CommandState::kExpired: return ExitCode::kExpired;
  }
  return ExitCode::kTrouble;
}

Json outcome_json(const AlarmAction& action, const StationOutcome& outcome) {
  Json json = {
      {"action", to_text(action.kind)}, {"bus", action.alarm.bus}, {"device", action.alarm.device}};
  if (!is_of_device(action.kind)) {
    json.add("channel", action.alarm.channel);
    json.add("limit", to_text(action.alarm.limit));
  }
  json.add("state", outcome ? to_text(outcome->state) : "failed");
  json.add("cause", outcome ? outcome->cause : "NO_ANSWER");
  json.add("reason", outcome ? outcome->reason : std::string(to_text(outcome.error())));
  return json;
}

}  // namespace

ExitCode act_on_alarms(const AlarmsOptions& options, const std::string& by,
                       const Connection& connection, Interrupt& interrupt, std::ostream& out,
                       std::ostream& err) {
  DomainView domain(connection, interrupt);
  const Told told = listen(domain, connection);
  if (const auto code = trouble(domain, told, connection, err)) return *code;
  const std::vector<AlarmAction> actions = actions_of(options, by, told.alarms);
  if (actions.empty()) {
    err << fmt::format("fieldcast alarms: of {} there is no alarm to {}\n", options.pattern.text(),
                       to_text(*options.action));
    return ExitCode::kNothing;
  }
  ExitCode worst = ExitCode::kOk;
  for (const AlarmAction& action : actions) {
    if (domain.interrupted()) return ExitCode::kInterrupted;
    const StationOutcome outcome = domain.station().execute(action);
    worst = std::max(worst, code_of(outcome));
    if (options.json) {
      out << outcome_json(action, outcome).text() << '\n';
    } else {
      out << printable(fmt::format("{}: {}", to_text(action.alarm), to_text(outcome))) << '\n';
    }
  }
  out.flush();
  return out ? worst : ExitCode::kTrouble;
}

ExitCode stored_alarms(const AlarmsOptions& options, std::ostream& out, std::ostream& err) {
  const auto address = resolve(options.source);
  if (!address) {
    err << address.error() << '\n';
    return ExitCode::kUsage;
  }
  const auto connection = open_store(*address, IfMissing::kFail);
  std::size_t count = 0;
  AlarmLifeTable(*connection)
      .log(options.span->from, options.span->to, [&](const AlarmLogEntry& entry) {
        ++count;
        out << (options.json ? record_json(entry).text() : alarm_line(entry)) << '\n';
        return out.good();
      });
  out.flush();
  if (!out) return ExitCode::kTrouble;
  if (count > 0) return ExitCode::kOk;
  err << "no alarm was raised or cleared in that time\n";
  return ExitCode::kNothing;
}

namespace {

constexpr Duration kShortest = std::chrono::seconds{1};

// Login name of the user at the shell; under sudo not root.
std::string login_name() {
  const uid_t user = ::getuid();
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets it
  const char* sudo = user == 0 ? std::getenv("SUDO_USER") : nullptr;
  if (sudo != nullptr && *sudo != '\0') return sudo;
  passwd entry{}, *found = nullptr;
  std::array<char, 4096> texts{};
  ::getpwuid_r(user, &entry, texts.data(), texts.size(), &found);
  return found == nullptr ? fmt::format("uid {}", user) : std::string(entry.pw_name);
}

class AlarmsCommand final : public CommandWith<AlarmsOptions> {
 public:
  void describe(CommandLine& line) override {
    span_.describe(line);
    line.when_given([this] { return finish(); });
    line.flag("--json", options_.json, "JSON lines, of those that are clear again too");
    line.text("--store", options_.source.store, "With --from: look into this store");
    add_connection(line, options_.connection);
    CommandLine& acknowledge = line.command("ack", "Acknowledge those that nobody has");
    describe_action(acknowledge, AlarmActionKind::kAcknowledge);
    CommandLine& shelve = line.command("shelve", "Put those that are not clear aside for a while");
    describe_action(shelve, AlarmActionKind::kShelve);
    shelve.duration("--for", options_.duration, kShortest, "How long, up to 24h").required();
    CommandLine& unshelve = line.command("unshelve", "Take those back that are shelved");
    describe_action(unshelve, AlarmActionKind::kUnshelve);
    CommandLine& maintenance =
        line.command("maintenance", "Suppress all alarms of a device while somebody works at it");
    describe_maintenance(maintenance);
    line.make_commands_optional();
  }
  ExitCode run(const Streams& streams) override {
    if (!options_.action && options_.span) return stored_alarms(options_, streams.out, streams.err);
    return in_domain(
        options_.connection, streams, [&](const Connection& connection, Interrupt& interrupt) {
          return options_.action
                     ? act_on_alarms(options_, login_name(), connection, interrupt, streams.out,
                                     streams.err)
                     : alarms(options_, connection, interrupt, streams.out, streams.err);
        });
  }

 private:
  void describe_common(CommandLine& line) {
    line.text("--note", options_.note, "One line for the others, up to 256 bytes");
    line.flag("--json", options_.json, "JSON lines");
    add_connection(line, options_.connection);
  }
  void describe_action(CommandLine& line, AlarmActionKind action) {
    line.value("PATTERN", pattern_into(options_.pattern), kPatternHelp).required();
    line.value(
        "--limit", [this](const std::string& text) { return read_limit(text); },
        "low-low, low, high or high-high; all of them if it is not given");
    describe_common(line);
    line.when_given([this, action]() -> std::optional<CommandLine::Fault> {
      options_.action = action;
      return note_fault();
    });
  }
  void describe_maintenance(CommandLine& line) {
    line.value(
            "DEVICE", [this](const std::string& text) { return read_device(text); }, "BUS/DEVICE")
        .required();
    line.duration("--for", maintenance_, kShortest, "How long, up to 7d");
    line.flag("--end", end_, "It has ended").excludes("--for");
    describe_common(line);
    line.when_given([this]() -> std::optional<CommandLine::Fault> {
      if (!maintenance_ && !end_) return CommandLine::Fault{"--for", "say --for 2h, or --end"};
      options_.action = end_ ? AlarmActionKind::kEndMaintenance : AlarmActionKind::kMaintenance;
      options_.duration = maintenance_.value_or(Duration{});
      return note_fault();
    });
  }
  std::optional<CommandLine::Fault> note_fault() const {
    if (options_.note.size() <= 256) return std::nullopt;
    return CommandLine::Fault{"--note", "a note has up to 256 bytes"};
  }
  std::optional<std::string> read_limit(const std::string& text) {
    options_.limit = limit_kind_from(text);
    if (options_.limit) return std::nullopt;
    return fmt::format("'{}' is no limit; low-low, low, high or high-high", printable(text));
  }
  std::optional<std::string> read_device(const std::string& text) {
    if (std::count(text.begin(), text.end(), '/') != 1 || text.find('*') != text.npos)
      return fmt::format("'{}' is no device; BUS/DEVICE", printable(text));
    return pattern_into(options_.pattern)(text);
  }
  std::optional<CommandLine::Fault> finish() {
    options_.source.config = options_.connection.config;
    return span_.given() ? span_.read(options_.span.emplace()) : std::nullopt;
  }

  SpanOption span_;
  std::optional<Duration> maintenance_;
  bool end_ = false;
};

}  // namespace

CommandEntry alarms_command();
CommandEntry alarms_command() {
  return {"alarms",
          "Show the limits that are passed now, acknowledge and shelve; with --from, what the "
          "store knows",
          make_command<AlarmsCommand>};
}

}  // namespace fieldcast::cli
