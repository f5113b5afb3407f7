#include "tools/cli/command/station/alarms.hpp"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ostream>
#include <utility>

#include "bridge/store/alarm_life_table.hpp"
#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/station_view.hpp"

namespace fieldcast::cli {
namespace {

AlarmKey key_of(const StationAlarm& alarm) {
  return {alarm.bus, alarm.device, alarm.channel, alarm.limit};
}

bool note_alarm(KnownAlarms& alarms, const DomainEvent& event, const Listening& listening) {
  if (const auto* bus = std::get_if<StationBusStatus>(&event))
    return !listening.heard_site_of(bus->bus);
  if (const auto* gone = std::get_if<AlarmGone>(&event)) alarms[key_of(gone->last)].alarm = {};
  if (const auto* gone = std::get_if<AlarmStatusGone>(&event)) alarms[gone->last.alarm].status = {};
  if (const auto* alarm = std::get_if<StationAlarm>(&event))
    return !std::exchange(alarms[key_of(*alarm)].alarm, *alarm);
  if (const auto* known = std::get_if<StationAlarmStatus>(&event))
    return !std::exchange(alarms[known->alarm].status, known->status);
  return false;
}

// Fails with the exit code if no bridge reported; then `err` has the reason.
tl::expected<KnownAlarms, ExitCode> current_alarms(DomainView& domain, const Connection& connection,
                                                   const Streams& to) {
  domain.subscribe_alarms();
  domain.subscribe_status();  // a bus without alarms still reports its status
  KnownAlarms alarms;
  const Listening listening = receive_reports(
      domain, connection, std::nullopt, to, [&](const DomainEvent& event, const Listening& heard) {
        return note_alarm(alarms, event, heard);
      });
  if (domain.interrupted()) return tl::unexpected(ExitCode::kInterrupted);
  if (const auto code =
          no_reports("alarms", domain, connection, listening, listening.anybody(), to.err))
    return tl::unexpected(*code);
  std::erase_if(alarms,
                [](const auto& entry) { return !entry.second.alarm && !entry.second.status; });
  return alarms;
}

// Returns kOk if a bridge reported, with or without alarms.
ExitCode show_alarms(const AlarmsOptions& options, DomainView& domain, const Connection& connection,
                     const Streams& to) {
  const auto alarms = current_alarms(domain, connection, to);
  if (!alarms) return alarms.error();
  if (options.json) {
    for (const auto& [key, known] : *alarms) to.out << alarm_json(key, known).text() << '\n';
  } else {
    const auto lines = alarm_lines(*alarms, utc_now(), to.wide_screen());
    if (lines.size() > 1) print(to.out, lines);  // more than the titles
    const bool active =
        std::ranges::any_of(*alarms, [](const auto& entry) { return entry.second.active(); });
    if (!active) to.out << "no alarm is active\n";
  }
  to.out.flush();
  return to.out ? ExitCode::kOk : ExitCode::kTrouble;
}

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
    case AlarmActionKind::kEndMaintenance:
    case AlarmActionKind::kEndSession: break;
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
  if (outcome) return exit_code_of(outcome->state);
  return outcome.error() == StationFault::kNoBridge ? ExitCode::kNoBridge : ExitCode::kNoResponse;
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

// `by`: the acting user. kNothing if no alarm matches, else the worst result. REQUIRES:
// options.action is set.
ExitCode act_on_alarms(const AlarmsOptions& options, const std::string& by, DomainView& domain,
                       const Connection& connection, const Streams& to) {
  const auto alarms = current_alarms(domain, connection, to);
  if (!alarms) return alarms.error();
  const std::vector<AlarmAction> actions = actions_of(options, by, *alarms);
  if (actions.empty()) {
    to.err << fmt::format("fieldcast alarms: of {} there is no alarm to {}\n",
                          options.pattern.text(), to_text(*options.action));
    return ExitCode::kNothing;
  }
  ExitCode worst = ExitCode::kOk;
  for (const AlarmAction& action : actions) {
    if (domain.interrupted()) return ExitCode::kInterrupted;
    const StationOutcome outcome = domain.station().execute(action);
    worst = std::max(worst, code_of(outcome));
    if (options.json) {
      to.out << outcome_json(action, outcome).text() << '\n';
    } else {
      to.out << printable(fmt::format("{}: {}", to_text(action.alarm), to_text(outcome))) << '\n';
    }
  }
  to.out.flush();
  return to.out ? worst : ExitCode::kTrouble;
}

ExitCode stored_alarms(const AlarmsOptions& options, const Streams& to) {
  return in_store(options.source, to.err, IfMissing::kFail, [&](SqlConnection& store) {
    std::size_t count = 0;
    AlarmLifeTable(store).log(
        options.span->from, options.span->to, [&](const AlarmLogEntry& entry) {
          ++count;
          to.out << (options.json ? record_json(entry).text() : alarm_line(entry)) << '\n';
          return to.out.good();
        });
    return end_of_records(to, count, "no alarm was raised or cleared in that time");
  });
}

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

ExitCode alarms(const AlarmsOptions& options, const Streams& to) {
  if (!options.action && options.span) return stored_alarms(options, to);
  return in_domain(options.connection, to, [&](const Connection& connection, Interrupt& interrupt) {
    DomainView domain(connection, interrupt);
    return options.action ? act_on_alarms(options, login_name(), domain, connection, to)
                          : show_alarms(options, domain, connection, to);
  });
}

std::optional<std::string> read_limit(const std::string& text, std::optional<LimitKind>& limit) {
  limit = limit_kind_from(text);
  if (limit) return std::nullopt;
  return fmt::format("'{}' is no limit; low-low, low, high or high-high", printable(text));
}

std::optional<std::string> read_device(const std::string& text, Pattern& pattern) {
  if (std::ranges::count(text, '/') != 1 || text.find('*') != text.npos)
    return fmt::format("'{}' is no device; BUS/DEVICE", printable(text));
  return pattern_into(pattern)(text);
}

std::optional<CommandLine::Fault> note_fault(const std::string& note) {
  if (note.size() <= 256) return std::nullopt;
  return CommandLine::Fault{"--note", "a note has up to 256 bytes"};
}

void describe_common(CommandLine& line, AlarmsOptions& options) {
  line.text("--note", options.note, "One line for the others, up to 256 bytes");
  line.flag("--json", options.json, "JSON lines");
  add_connection(line, options.connection);
}

void describe_action(CommandLine& line, AlarmsOptions& options, AlarmActionKind action) {
  line.value("PATTERN", pattern_into(options.pattern), kPatternHelp).required();
  line.value(
      "--limit", [&options](const std::string& text) { return read_limit(text, options.limit); },
      "low-low, low, high or high-high; all of them if it is not given");
  describe_common(line, options);
  line.when_given([&options, action] {
    options.action = action;
    return note_fault(options.note);
  });
}

void describe_maintenance(CommandLine& line, AlarmsOptions& options) {
  line.value(
          "DEVICE",
          [&options](const std::string& text) { return read_device(text, options.pattern); },
          "BUS/DEVICE")
      .required();
  line.duration("--for", options.maintenance, kShortest, "How long, up to 7d");
  line.flag("--end", options.end, "It has ended").excludes("--for");
  describe_common(line, options);
  line.when_given([&options]() -> std::optional<CommandLine::Fault> {
    if (!options.maintenance && !options.end)
      return CommandLine::Fault{"--for", "say --for 2h, or --end"};
    options.action = options.end ? AlarmActionKind::kEndMaintenance : AlarmActionKind::kMaintenance;
    options.duration = options.maintenance.value_or(Duration{});
    return note_fault(options.note);
  });
}

void describe_alarms(CommandLine& line, AlarmsOptions& options) {
  add_span(line, options.span, [&options]() -> std::optional<CommandLine::Fault> {
    options.source.config = options.connection.config;
    if (options.span || options.source.store.empty()) return std::nullopt;
    return CommandLine::Fault{"--store", "goes with --from or --to"};
  });
  line.flag("--json", options.json, "JSON lines, of those that are clear again too");
  line.text("--store", options.source.store, "With --from: look into this store");
  add_connection(line, options.connection);
  CommandLine& acknowledge = line.command("ack", "Acknowledge those that nobody has");
  describe_action(acknowledge, options, AlarmActionKind::kAcknowledge);
  CommandLine& shelve = line.command("shelve", "Put those that are not clear aside for a while");
  describe_action(shelve, options, AlarmActionKind::kShelve);
  shelve.duration("--for", options.duration, kShortest, "How long, up to 24h").required();
  CommandLine& unshelve = line.command("unshelve", "Take those back that are shelved");
  describe_action(unshelve, options, AlarmActionKind::kUnshelve);
  CommandLine& maintenance =
      line.command("maintenance", "Suppress all alarms of a device while somebody works at it");
  describe_maintenance(maintenance, options);
  line.make_commands_optional();
}

}  // namespace

CommandRow alarms_command() {
  return command_row("alarms",
                     "Show the limits that are passed now, acknowledge and shelve; with --from, "
                     "what the store knows",
                     describe_alarms, alarms);
}

}  // namespace fieldcast::cli
