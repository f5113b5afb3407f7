#include "tools/cli/view/station_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {

namespace {

using Entry = KnownAlarms::value_type;

bool is_away(const AlarmStatus& status) {
  return status.shelved.is_set() || status.suppressed.is_set();
}

// Sort key; lower is more urgent.
auto urgency(const Entry& entry) {
  const AlarmStatus status = entry.second.status.value_or(AlarmStatus{});
  const int waits = is_away(status)                             ? 3
                    : status.stage == AlarmStage::kAcknowledged ? 2
                    : status.stage == AlarmStage::kReturned     ? 1
                                                                : 0;
  return std::tuple(waits, -static_cast<int>(status.priority), status.since());
}

std::string remaining(const AlarmPause& pause, UtcTime now) {
  return fmt::format("{} more", age_text(now, pause.until));
}

Cell state_cell(const KnownAlarm& known, UtcTime now) {
  if (!known.status) return {"active", Tone::kBad};
  const AlarmStatus& status = *known.status;
  if (status.suppressed.is_set())
    return {"maintenance, " + remaining(status.suppressed, now), Tone::kFaint};
  if (status.shelved.is_set()) return {"shelved, " + remaining(status.shelved, now), Tone::kFaint};
  std::string text(to_text(status.stage));
  if (status.chattering) text += ", chattering";
  const Tone tone = status.stage == AlarmStage::kUnacknowledged ? Tone::kBad
                    : status.stage == AlarmStage::kReturned     ? Tone::kWarning
                                                                : Tone::kPlain;
  return {std::move(text), tone};
}

std::string said_by(const std::string& by, const std::string& note) {
  return printable(note.empty() ? by : by + ": " + note);
}

std::string people(const KnownAlarm& known) {
  if (!known.status) return {};
  const AlarmStatus& status = *known.status;
  if (status.suppressed.is_set()) return said_by(status.suppressed.by, status.suppressed.note);
  if (status.shelved.is_set()) return said_by(status.shelved.by, status.shelved.note);
  if (status.stage == AlarmStage::kAcknowledged)
    return said_by(status.acknowledged.by, status.acknowledged.note);
  return {};
}

void add_pause(Json& json, const std::string& name, const AlarmPause& pause) {
  if (!pause.is_set()) return;
  json.add(name + "_by", pause.by);
  json.add(name + "_note", pause.note);
  json.add(name + "_since", pause.since.nanoseconds);
  json.add(name + "_until", pause.until.nanoseconds);
}

std::string path_of(const AlarmKey& key) {
  return printable(key.bus + '/' + key.device + '/' + key.channel);
}

}  // namespace

bool KnownAlarm::active() const {
  return status ? status->active : alarm && alarm->state == AlarmState::kActive;
}

bool KnownAlarm::is_shown() const {
  if (!status) return active();
  return status->stage != AlarmStage::kClear || status->shelved.is_set();
}

std::vector<std::string> alarm_lines(const KnownAlarms& alarms, UtcTime now, const Screen& screen) {
  std::vector<const Entry*> shown;
  for (const Entry& entry : alarms) {
    if (entry.second.is_shown()) shown.push_back(&entry);
  }
  std::stable_sort(shown.begin(), shown.end(),
                   [](const Entry* a, const Entry* b) { return urgency(*a) < urgency(*b); });
  TextTable table({{"channel"},
                   {"limit"},
                   {"priority"},
                   {"state"},
                   {"value", Align::kRight},
                   {"for", Align::kRight},
                   {"since"},
                   {"by"}});
  for (const Entry* entry : shown) {
    const auto& [key, known] = *entry;
    const UtcTime since = known.status ? known.status->since() : known.alarm->since;
    table.add_row({{path_of(key)},
                   {std::string(to_text(key.limit))},
                   {known.status ? std::string(to_text(known.status->priority)) : ""},
                   state_cell(known, now),
                   {value_text(known.status ? known.status->value : known.alarm->value, {})},
                   {since.nanoseconds == 0 ? "-" : age_text(since, now)},
                   {since.nanoseconds == 0 ? "-" : utc_text(since), Tone::kFaint},
                   {people(known)}});
  }
  return table.render(screen);
}

Json alarm_json(const AlarmKey& key, const KnownAlarm& known) {
  Json json = {
      {"bus", key.bus},
      {"device", key.device},
      {"channel", key.channel},
      {"limit", to_text(key.limit)},
      {"state", to_text(known.active() ? AlarmState::kActive : AlarmState::kClear)},
      {"value", known.status ? known.status->value : known.alarm->value},
      {"since", known.status ? known.status->since().nanoseconds : known.alarm->since.nanoseconds}};
  if (!known.status) return json;
  const AlarmStatus& status = *known.status;
  json.add("priority", to_text(status.priority));
  json.add("stage", to_text(status.stage));
  json.add("raised_at", status.raised_at.nanoseconds);
  json.add("cleared_at", status.cleared_at.nanoseconds);
  json.add("occurrences", status.occurrences);
  json.add("chattering", status.chattering);
  if (status.acknowledged.at.nanoseconds != 0) {
    json.add("acknowledged_by", status.acknowledged.by);
    json.add("acknowledged_at", status.acknowledged.at.nanoseconds);
    json.add("acknowledged_note", status.acknowledged.note);
  }
  add_pause(json, "shelved", status.shelved);
  add_pause(json, "suppressed", status.suppressed);
  return json;
}

std::string alarm_line(const AlarmLogEntry& entry) {
  std::string line = fmt::format("{}  {}/{}", utc_text(entry.at), entry.bus, entry.device);
  if (!entry.channel.empty()) line += fmt::format("/{}  {}", entry.channel, entry.limit);
  line += (entry.channel.empty() ? "  " : " ") + entry.event;
  if (entry.value) line += "  " + value_text(*entry.value, {});
  if (!entry.who.empty()) line += " by " + entry.who;
  if (entry.until.nanoseconds != 0) line += " until " + utc_text(entry.until);
  if (!entry.note.empty()) line += ": " + entry.note;
  return printable(line);
}

Json record_json(const AlarmLogEntry& entry) {
  Json json = {{"bus", entry.bus},     {"device", entry.device}, {"channel", entry.channel},
               {"limit", entry.limit}, {"event", entry.event},   {"at", entry.at.nanoseconds}};
  if (entry.value) {
    json.add("state", entry.event == "raised" ? "active" : "clear");
    json.add("value", *entry.value);
    json.add("since", entry.at.nanoseconds);
    return json;
  }
  json.add("who", entry.who);
  json.add("note", entry.note);
  if (entry.until.nanoseconds != 0) json.add("until", entry.until.nanoseconds);
  return json;
}

std::vector<std::string> sessions_lines(const SessionsModel& model, UtcTime now,
                                        const Screen& screen) {
  if (model.empty()) return {"no device has been programmed"};
  TextTable table({{"device"},
                   {"state"},
                   {"who"},
                   {"bytes to it", Align::kRight},
                   {"from it", Align::kRight},
                   {"begun", Align::kRight}});
  for (const auto& [key, session] : model) {
    table.add_row({{session.bus + '/' + session.device},
                   {std::string(to_text(session.state)),
                    session.state == ProgramSessionState::kOpen ? Tone::kGood : Tone::kFaint},
                   {session.who},
                   {std::to_string(session.bytes_to_device)},
                   {std::to_string(session.bytes_from_device)},
                   {age_text(session.since, now), Tone::kFaint}});
  }
  return table.render(screen);
}

Json session_json(const ProgramSessionReport& session) {
  return {{"bus", session.bus},
          {"device", session.device},
          {"state", to_text(session.state)},
          {"who", session.who},
          {"bytes_to_device", session.bytes_to_device},
          {"bytes_from_device", session.bytes_from_device},
          {"since", session.since.nanoseconds}};
}

ChannelCells channel_cells(const ChannelPath& path, const WatchModel::Row& row,
                           const StationChannel* about, const Moment& moment) {
  const auto& sample = row.sample;
  const bool read = sample.acquired_at.nanoseconds != 0;
  return {{{path.text()},
           {read ? value_text(sample.value, about != nullptr ? about->type : std::string{}) : "-",
            Tone::kTitle},
           {about != nullptr ? about->unit : ""},
           row.gone ? Cell{"GONE", Tone::kBad}
                    : Cell{quality_text(sample, about), tone_of(sample.quality)},
           {age_text(sample.acquired_at, moment.utc), age_tone(sample, about, moment.utc)},
           {about == nullptr || about->refresh == Duration{} ? "-" : to_text(about->refresh),
            Tone::kFaint},
           {rate_text(row.rate.rate(moment.now)), Tone::kFaint}}};
}

std::vector<std::string> watch_lines(const WatchModel& model, Instant now, UtcTime utc,
                                     const Screen& screen) {
  const auto& rows = model.rows();
  const auto lag = model.lag_remark();
  const std::size_t around = lag ? 4 : 3;  // title, head, remainder, lag remark
  const bool cut = screen.rows != 0 && rows.size() + around - 1 > screen.rows;
  const std::size_t shown = !cut ? rows.size() : screen.rows > around ? screen.rows - around : 1;

  TextTable table({{"channel"},
                   {"value", Align::kRight},
                   {"unit"},
                   {"quality"},
                   {"age", Align::kRight},
                   {"refresh", Align::kRight},
                   {"rate", Align::kRight}});
  for (const auto& [path, row] : rows) {
    if (table.rows() == shown) break;
    const ChannelCells cells = channel_cells(path, row, model.catalogue().find(path), {now, utc});
    table.add_row({cells.begin(), cells.end()});
  }

  const auto title = fmt::format("fieldcast watch {}   {}   {}   {}", model.pattern().text(),
                                 model.summary(), rate_text(model.rate(now)), utc_text(utc));
  std::vector<std::string> lines{screen.columns == 0 ? title : clip(title, screen.columns)};
  for (auto& line : table.render(screen)) lines.push_back(std::move(line));
  if (cut) {
    const auto more =
        fmt::format(".. and {} more: narrow the pattern (BUS/DEVICE), or a taller terminal",
                    rows.size() - shown);
    lines.push_back(screen.columns == 0 ? more : clip(more, screen.columns));
  }
  if (lag) lines.push_back(screen.columns == 0 ? *lag : clip(*lag, screen.columns));
  return lines;
}

Json lag_json(const Station::BlockCounters& counters) {
  return {{"event", "too_slow"},
          {"blocks_missed", counters.missing},
          {"last_values_requests", counters.requests}};
}

}  // namespace fieldcast::cli
