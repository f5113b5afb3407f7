#include "tools/cli/view/status/status_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/text/cell_text.hpp"

namespace fieldcast::cli {

namespace {

constexpr std::size_t kNamedBridges = 3;  // of one kind; further bridges are only counted

std::string named(const std::vector<const StationBridge*>& bridges) {
  std::string text;
  for (std::size_t i = 0; i < std::min(bridges.size(), kNamedBridges); ++i)
    text += fmt::format("{}bridge {} on host {}", i == 0 ? "" : ", ", bridges[i]->bridge,
                        bridges[i]->host);
  if (bridges.size() > kNamedBridges)
    text += fmt::format(" and {} more", bridges.size() - kNamedBridges);
  return text;
}

Json claimants_json(const std::vector<const StationBridge*>& bridges) {
  Json all = Json::array();
  for (const StationBridge* each : bridges)
    all.push_back({{"bridge", each->bridge}, {"host", each->host}});
  return all;
}

}  // namespace

BusClaimants claimants_of(const StatusModel& model, const StationBusStatus& bus) {
  const auto own = model.bridges.find(bus.bridge);
  const std::string group = own == model.bridges.end() ? "" : own->second.standby_group;
  BusClaimants found;
  for (const auto& [name, bridge] : model.bridges) {
    if (name == bus.bridge || (!group.empty() && bridge.standby_group == group)) continue;
    const auto claim = std::ranges::find(bridge.buses, bus.bus, &StationBridge::Bus::bus);
    if (claim == bridge.buses.end()) continue;
    (claim->serving ? found.serving : found.waiting).push_back(&bridge);
  }
  return found;
}

std::vector<StatusFact> claim_facts(const StatusModel& model, const StationBusStatus& bus) {
  const BusClaimants others = claimants_of(model, bus);
  std::vector<StatusFact> facts;
  if (!others.serving.empty()) {
    facts.push_back(
        {"claims",
         fmt::format("contested: {} also claims to serve bus {}, whose name must be unique in the "
                     "DDS domain; stop or rename one of them",
                     named(others.serving), bus.bus),
         Tone::kBad});
  }
  if (!others.waiting.empty()) {
    facts.push_back(
        {"claims",
         fmt::format("refused: {} has a bus of this name and does not serve it, because bridge "
                     "{} does; rename one of the buses",
                     named(others.waiting), bus.bridge),
         Tone::kWarning});
  }
  return facts;
}

void add_claims(Json& line, const StatusModel& model, const StationBusStatus& bus) {
  const BusClaimants others = claimants_of(model, bus);
  if (!others.serving.empty()) line.add("contested_by", claimants_json(others.serving));
  if (!others.waiting.empty()) line.add("waiting_bridges", claimants_json(others.waiting));
}

namespace {

constexpr std::size_t kPlainColumns = 80;
constexpr std::size_t kFactIndent = 12;

void add_facts(std::vector<std::string>& lines, const std::vector<StatusFact>& facts,
               const Screen& screen) {
  const std::size_t columns = screen.columns != 0 ? screen.columns : kPlainColumns;
  for (const StatusFact& fact : facts) {
    const auto name = fitted(fact.name, kFactIndent - 4);
    std::string before = "  " + name + "  ";
    for (const auto& text : wrapped(
             shown(fact.text), columns > 2 * kFactIndent ? columns - kFactIndent : kFactIndent)) {
      lines.push_back(before + painted(text, fact.tone, screen.colour));
      before.assign(kFactIndent, ' ');
    }
  }
}

using DeviceEntry = std::map<std::pair<std::string, std::string>, StationDeviceStatus>::value_type;

TextTable device_table(const std::vector<const DeviceEntry*>& devices) {
  TextTable table({{"  bus/device"},
                   {"state"},
                   {"responds in", Align::kRight},
                   {"timeout", Align::kRight},
                   {"exchanges", Align::kRight},
                   {"failed", Align::kRight},
                   {"missed", Align::kRight}});
  for (const DeviceEntry* entry : devices) {
    const auto& report = entry->second.report;
    table.add_row(
        {{"  " + entry->first.first + '/' + entry->first.second},
         {std::string(to_text(report.state)), tone_of(report.state)},
         {milliseconds_text(report.response_time)},
         {milliseconds_text(report.timeout)},
         {std::to_string(report.exchanges)},
         {std::to_string(report.failures), report.failures == 0 ? Tone::kPlain : Tone::kWarning},
         {std::to_string(report.deadline_misses),
          report.deadline_misses == 0 ? Tone::kPlain : Tone::kWarning}});
  }
  return table;
}

int order_of(DeviceState state) {
  switch (state) {
    case DeviceState::kOffline: return 0;
    case DeviceState::kDegraded: return 1;
    case DeviceState::kUnknown: return 2;
    case DeviceState::kOnline: break;
  }
  return 3;
}

void add_devices(std::vector<std::string>& lines, const StatusModel& model, const std::string& bus,
                 const StationBusStatus* status, const Screen& screen) {
  std::vector<const DeviceEntry*> devices;
  for (const DeviceEntry& entry : model.devices) {
    if (entry.first.first == bus) devices.push_back(&entry);
  }
  if (devices.empty()) return;
  std::ranges::stable_sort(devices, {},
                           [](const auto* entry) { return order_of(entry->second.report.state); });
  for (auto& line : device_table(devices).render({0, 0, screen.colour}))
    lines.push_back(std::move(line));
  for (const DeviceEntry* entry : devices) {
    std::vector<StatusFact> special;
    for (StatusFact& fact : device_facts(entry->second, status)) {
      const bool in_table = fact.name == "times" || fact.name == "so far" ||
                            (fact.name == "state" && fact.text == "online");
      if (!in_table) special.push_back(std::move(fact));
    }
    if (special.empty()) continue;
    lines.push_back(painted(shown(bus + '/' + entry->first.second), Tone::kTitle, screen.colour));
    add_facts(lines, special, screen);
  }
}

}  // namespace

std::vector<std::string> status_lines(const StatusModel& model, UtcTime now, const Screen& screen) {
  std::vector<std::string> lines;
  std::set<std::string> names;
  for (const auto& [name, bus] : model.buses) names.insert(name);
  for (const auto& [key, device] : model.devices) names.insert(key.first);
  for (const std::string& name : names) {
    if (!lines.empty()) lines.emplace_back();
    const auto found = model.buses.find(name);
    const StationBusStatus* bus = found == model.buses.end() ? nullptr : &found->second;
    std::string head = "bus " + name;
    if (bus != nullptr)
      head +=
          fmt::format("  bridge {}, reported {} ago", bus->bridge, age_text(bus->reported_at, now));
    lines.push_back(painted(shown(head), Tone::kTitle, screen.colour));
    if (bus != nullptr) add_facts(lines, bus_facts(*bus), screen);
    if (bus != nullptr) add_facts(lines, claim_facts(model, *bus), screen);
    add_devices(lines, model, name, bus, screen);
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
            {"causes", status.causes},
            {"misses", status.misses},
            {"reported_at", status.reported_at.nanoseconds}};
  if (report.closed_because != Cause::kNone)
    line.add("closed_because", to_name(report.closed_because));
  if (status.clock_ahead) line.add("clock_ahead", status.clock_ahead->count());
  return line;
}

Json status_json(const StationDeviceStatus& status) {
  const auto& report = status.report;
  Json areas = Json::array();
  for (const AreaReport& area : report.areas)
    areas.push_back({{"area", area.area},
                     {"answer_time", area.response_time.count()},
                     {"answer_spread", area.response_spread.count()},
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
          {"answer_time", report.response_time.count()},
          {"answer_spread", report.response_spread.count()},
          {"timeout", report.timeout.count()},
          {"pause", report.pause.count()},
          {"areas", areas},
          {"refused", report.refused},
          {"refused_gaps", report.refused_gaps},
          {"causes", status.causes},
          {"reported_at", status.reported_at.nanoseconds}};
}

}  // namespace fieldcast::cli
