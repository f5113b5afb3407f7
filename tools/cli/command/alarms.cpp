#include "tools/cli/command/alarms.hpp"

#include <algorithm>
#include <ostream>

#include "bridge/store/event_table.hpp"
#include "tools/cli/clock.hpp"
#include "tools/cli/command/command.hpp"
#include "tools/cli/command/in_domain.hpp"
#include "tools/cli/command/span_option.hpp"
#include "tools/cli/console.hpp"
#include "tools/cli/domain_view.hpp"
#include "tools/cli/view/record_view.hpp"

namespace fieldcast::cli {
namespace {

using Key = std::tuple<std::string, std::string, std::string, LimitKind>;
Key key_of(const StationAlarm& alarm) {
  return {alarm.bus, alarm.device, alarm.channel, alarm.limit};
}

AlarmRecord record_of(const StationAlarm& alarm) {
  return {alarm.bus,
          alarm.device,
          alarm.channel,
          std::string(to_text(alarm.limit)),
          std::string(to_text(alarm.state)),
          alarm.value,
          alarm.since};
}

}  // namespace

ExitCode alarms(const AlarmsOptions& options, const DdsSpec& spec, Interrupt& interrupt,
                std::ostream& out, std::ostream& err) {
  DomainView domain(spec, interrupt);
  domain.subscribe_alarms();
  domain.subscribe_status();  // where no alarm is, a bus still reports
  std::map<Key, StationAlarm> known;
  bool bridge = false;
  const auto began = instant_now();
  const auto end = began + kBridgeWait;
  auto last_news = began;
  for (auto now = began; now < end && !domain.inbox().closed(); now = instant_now()) {
    if (bridge && now - last_news >= kQuietTime) break;
    for (const auto& event :
         domain.inbox().take_all(to_steady(bridge ? std::min(end, last_news + kQuietTime) : end))) {
      if (std::holds_alternative<StationBusStatus>(event) && !std::exchange(bridge, true))
        last_news = instant_now();
      if (const auto* gone = std::get_if<AlarmGone>(&event)) known.erase(key_of(gone->last));
      if (const auto* alarm = std::get_if<StationAlarm>(&event)) {
        if (known.insert_or_assign(key_of(*alarm), *alarm).second) last_news = instant_now();
      }
    }
  }
  if (domain.interrupted()) return ExitCode::kInterrupted;
  if (!bridge) {
    err << "fieldcast alarms: " << no_bridge_text(spec) << '\n';
    return ExitCode::kNoBridge;
  }
  std::vector<AlarmRecord> records;
  for (const auto& [key, alarm] : known) {
    if (options.json) out << to_line(record_json(record_of(alarm))) << '\n';
    if (alarm.state == AlarmState::kActive) records.push_back(record_of(alarm));
  }
  if (!options.json && !records.empty()) {
    for (const auto& line : alarm_lines(records, utc_now(), {0, 0, output_screen().colour}))
      out << line << '\n';
  }
  if (!options.json && records.empty()) out << "no alarm is active\n";
  out.flush();
  return out ? ExitCode::kOk : ExitCode::kTrouble;
}

ExitCode stored_alarms(const AlarmsOptions& options, std::ostream& out, std::ostream& err) {
  const auto address = resolve(options.source);
  if (!address) {
    err << address.error() << '\n';
    return ExitCode::kUsage;
  }
  const auto connection = open_store(*address, IfMissing::kFail);
  std::size_t count = 0;
  EventTable(*connection)
      .alarms(options.span->from, options.span->to, [&](const AlarmRecord& alarm) {
        ++count;
        out << (options.json ? to_line(record_json(alarm)) : alarm_line(alarm)) << '\n';
        return out.good();
      });
  out.flush();
  if (!out) return ExitCode::kTrouble;
  if (count > 0) return ExitCode::kOk;
  err << "no alarm was raised or cleared in that time\n";
  return ExitCode::kNothing;
}

namespace {

class AlarmsCommand final : public CommandWith<AlarmsOptions> {
 public:
  void describe(CommandLine& line) override {
    span_.describe(line);
    line.when_given([this] { return finish(); });
    line.flag("--json", options_.json, "JSON lines, of those that are clear again too");
    line.text("--store", options_.source.store, "With --from: look into this store");
    add_connection(line, options_.connection);
  }
  ExitCode run(const Streams& streams) override {
    if (options_.span) return stored_alarms(options_, streams.out, streams.err);
    return in_domain(options_.connection, streams, [&](const DdsSpec& spec, Interrupt& interrupt) {
      return alarms(options_, spec, interrupt, streams.out, streams.err);
    });
  }

 private:
  std::optional<CommandLine::Fault> finish() {
    options_.source.config = options_.connection.config;
    return span_.given() ? span_.read(options_.span.emplace()) : std::nullopt;
  }

  SpanOption span_;
};

}  // namespace

CommandEntry alarms_command();
CommandEntry alarms_command() {
  return {"alarms", "Show the limits that are passed now; with --from, what the store knows",
          make_command<AlarmsCommand>};
}

}  // namespace fieldcast::cli
