#include "tools/cli/view/status_view.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>

#include "tools/cli/view/sample_text.hpp"

namespace fieldcast::cli {
namespace {

std::string formatted(const char* format, double number) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, number);
  return buffer.data();
}

std::string percent(double share) { return formatted("%.1f %%", share * 100); }
std::string milliseconds(Duration time) {
  return time == Duration{} ? "-" : formatted("%.2f ms", to_seconds(time) * 1e3);
}

std::string causes_text(const CauseCounts& causes) {
  std::string text;
  for (const auto& [name, count] : causes)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, count);
  return text;
}

std::string spaced(const std::vector<std::string>& addresses) {
  std::string text;
  for (const auto& at : addresses) text += (text.empty() ? "" : " ") + at;
  return text;
}

// "holding 2.10 ms, blocks to 60, at most 64"
std::string areas_text(const std::vector<AreaReport>& areas) {
  std::string text;
  for (const AreaReport& area : areas) {
    text += fmt::format("{}{} {}, blocks to {}", text.empty() ? "" : "; ", area.area,
                        milliseconds(area.answer_time), area.largest_block);
    if (area.longest_block != 0) text += fmt::format(", at most {}", area.longest_block);
  }
  return text;
}

Tone tone_of(BusState state) {
  return state == BusState::kRunning  ? Tone::kGood
         : state == BusState::kClosed ? Tone::kBad
                                      : Tone::kWarning;
}

Tone tone_of(DeviceState state) {
  switch (state) {
    case DeviceState::kOnline: return Tone::kGood;
    case DeviceState::kOffline: return Tone::kBad;
    default: return Tone::kWarning;
  }
}

// "closed: no such device file"
std::string state_text(const BusReport& report) {
  std::string text(to_text(report.state));
  if (report.closed_because != Cause::kNone && report.closed_because != Cause::kPortClosed)
    text += fmt::format(": {}", to_text(report.closed_because));
  return text;
}

// What to look at where a device answers and its answers cannot be read.
std::vector<std::string> hints(const StatusModel& model) {
  std::vector<std::string> lines;
  for (const auto& [key, status] : model.devices) {
    if (status.report.state == DeviceState::kOnline || status.report.state == DeviceState::kUnknown)
      continue;
    CauseCounts broken;
    for (const Cause cause : {Cause::kTruncated, Cause::kChecksum, Cause::kMalformed,
                              Cause::kForeign, Cause::kOverlong}) {
      const auto found = status.causes.find(std::string(to_name(cause)));
      if (found != status.causes.end()) broken.insert(*found);
    }
    if (broken.empty()) continue;
    lines.push_back(fmt::format(
        "{}/{}: bytes come that are no answers ({}): baud, parity or stop bits may be wrong, or "
        "two devices share an address; the bridge's log says what the bytes look like",
        key.first, key.second, causes_text(broken)));
  }
  return lines;
}

Tone load_tone(double share) {
  return share > 1 ? Tone::kBad : share > 0.9 ? Tone::kWarning : Tone::kPlain;
}

TextTable bus_table(const StatusModel& model, UtcTime now) {
  TextTable table({{"bus"},
                   {"state"},
                   {"wire", Align::kRight},
                   {"planned", Align::kRight},
                   {"reading", Align::kRight},
                   {"stretch", Align::kRight},
                   {"exchanges", Align::kRight},
                   {"samples", Align::kRight},
                   {"commands", Align::kRight},
                   {"missed", Align::kRight},
                   {"reopened", Align::kRight},
                   {"age", Align::kRight},
                   {"failures"},
                   {"missed because"}});
  for (const auto& [name, status] : model.buses) {
    const auto& report = status.report;
    table.add_row(
        {{name},
         {state_text(report), tone_of(report.state)},
         {percent(report.utilisation)},
         {percent(report.planned_load), load_tone(report.planned_load)},
         {percent(report.measured_load)},
         {formatted("%.2f", report.stretch), report.stretch > 1 ? Tone::kBad : Tone::kPlain},
         {std::to_string(report.exchanges)},
         {std::to_string(report.samples)},
         {std::to_string(report.commands)},
         {std::to_string(report.deadline_misses),
          report.deadline_misses == 0 ? Tone::kPlain : Tone::kWarning},
         {std::to_string(report.reopened)},
         {age_text(status.reported_at, now), Tone::kFaint},
         {causes_text(status.causes), Tone::kWarning},
         {causes_text(status.misses), Tone::kWarning}});
  }
  return table;
}

TextTable device_table(const StatusModel& model) {
  TextTable table({{"device"},
                   {"state"},
                   {"answers in", Align::kRight},
                   {"spread", Align::kRight},
                   {"timeout", Align::kRight},
                   {"rests", Align::kRight},
                   {"exchanges", Align::kRight},
                   {"failures", Align::kRight},
                   {"retries", Align::kRight},
                   {"missed", Align::kRight},
                   {"areas"},
                   {"refused"},
                   {"gaps refused"},
                   {"causes"}});
  for (const auto& [key, status] : model.devices) {
    const auto& report = status.report;
    table.add_row(
        {{key.first + '/' + key.second},
         {std::string(to_text(report.state)), tone_of(report.state)},
         {milliseconds(report.answer_time)},
         {milliseconds(report.answer_spread), Tone::kFaint},
         {milliseconds(report.timeout)},
         {milliseconds(report.pause), Tone::kFaint},
         {std::to_string(report.exchanges)},
         {std::to_string(report.failures), report.failures == 0 ? Tone::kPlain : Tone::kWarning},
         {std::to_string(report.retries)},
         {std::to_string(report.deadline_misses),
          report.deadline_misses == 0 ? Tone::kPlain : Tone::kWarning},
         {areas_text(report.areas)},
         {spaced(report.refused), Tone::kWarning},
         {spaced(report.refused_gaps), Tone::kWarning},
         {causes_text(status.causes), Tone::kWarning}});
  }
  return table;
}

}  // namespace

std::vector<std::string> status_lines(const StatusModel& model, UtcTime now, const Screen& screen) {
  auto lines = bus_table(model, now).render(screen);
  if (!model.devices.empty()) {
    lines.emplace_back();
    for (auto& line : device_table(model).render(screen)) lines.push_back(std::move(line));
    const auto more = hints(model);
    if (!more.empty()) lines.emplace_back();
    for (const auto& hint : more) lines.push_back(printable(hint));
  }
  return lines;
}

Json status_json(const StationBusStatus& status) {
  const auto& report = status.report;
  Json line{{"topic", "BusStatus"},
            {"bridge", status.bridge},
            {"bus", status.bus},
            {"state", to_text(report.state)},
            {"utilisation", report.utilisation},
            {"planned_load", report.planned_load},
            {"measured_load", report.measured_load},
            {"stretch", report.stretch},
            {"exchanges", report.exchanges},
            {"samples", report.samples},
            {"commands", report.commands},
            {"deadline_misses", report.deadline_misses},
            {"bytes_sent", report.bytes_sent},
            {"bytes_received", report.bytes_received},
            {"reopened", report.reopened},
            {"dds_deadline_misses", status.dds_deadline_misses},
            {"causes", Json(status.causes)},
            {"misses", Json(status.misses)},
            {"reported_at", status.reported_at.nanoseconds}};
  if (report.closed_because != Cause::kNone)
    line["closed_because"] = to_name(report.closed_because);
  return line;
}

Json status_json(const StationDeviceStatus& status) {
  const auto& report = status.report;
  Json areas = Json::array();
  for (const AreaReport& area : report.areas)
    areas.push_back({{"area", area.area},
                     {"answer_time", area.answer_time.count()},
                     {"answer_spread", area.answer_spread.count()},
                     {"largest_block", area.largest_block},
                     {"longest_block", area.longest_block}});
  return {{"topic", "DeviceStatus"},
          {"bus", status.bus},
          {"device", status.device},
          {"state", to_text(report.state)},
          {"exchanges", report.exchanges},
          {"failures", report.failures},
          {"retries", report.retries},
          {"deadline_misses", report.deadline_misses},
          {"answer_time", report.answer_time.count()},
          {"answer_spread", report.answer_spread.count()},
          {"timeout", report.timeout.count()},
          {"pause", report.pause.count()},
          {"areas", std::move(areas)},
          {"refused", report.refused},
          {"refused_gaps", report.refused_gaps},
          {"causes", Json(status.causes)},
          {"reported_at", status.reported_at.nanoseconds}};
}

}  // namespace fieldcast::cli
