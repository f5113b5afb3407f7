#include "tools/cli/screen/status_details.hpp"

#include <fmt/format.h>

#include <string>

#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/screen/list_control.hpp"
#include "tools/cli/screen/status_rows.hpp"
#include "tools/cli/text/cell_text.hpp"
#include "tools/cli/view/status/claims_view.hpp"
#include "tools/cli/view/status/standby_facts.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::size_t kNameColumns = 10;

const StationBusStatus* bus_of(const StatusModel& model, const ChannelPath& id) {
  const auto found = model.buses.find(id.bus);
  return found == model.buses.end() ? nullptr : &found->second;
}

const StationDeviceStatus* device_of(const StatusModel& model, const ChannelPath& id) {
  const auto found = model.devices.find({id.bus, id.device});
  return found == model.devices.end() ? nullptr : &found->second;
}

void add_fact(std::vector<FrameLine>& lines, const StatusFact& fact, std::size_t columns) {
  const std::size_t names = columns < 44 ? 2 : kNameColumns;
  const std::string name = columns < 44 ? std::string(names, ' ') : fitted(fact.name, names);
  const std::size_t left = columns > names ? columns - names : 1;
  bool first = true;
  for (const std::string& text : wrapped(shown(fact.text), left)) {
    lines.push_back(
        {{{first ? name : std::string(names, ' '), Tone::kFaint}, {text, fact.tone}}, false});
    first = false;
  }
}

std::vector<FrameLine> standby_details(const StatusModel& model, const ChannelPath& id,
                                       std::size_t columns) {
  const StandbyMessage* const member = id.device.empty() ? nullptr : member_of(model, id);
  const std::string group = standby_group_of(id);
  const std::string name = "standby group " + group;
  std::vector<FrameLine> lines{
      full_line({{shown(id.device.empty() ? name : id.device), Tone::kTitle},
                 {id.device.empty() ? std::string{} : "  of " + shown(name)}},
                columns, true)};
  if (!id.device.empty() && member == nullptr) return lines;
  for (const StatusFact& fact :
       member == nullptr ? group_facts(model.members, group) : member_facts(model.members, *member))
    add_fact(lines, fact, columns);
  return lines;
}

}  // namespace

Span group_state(const StatusModel& model, const ChannelPath& id) {
  if (id.device.empty()) {
    const auto* bus = bus_of(model, id);
    if (bus != nullptr && !claimants_of(model, *bus).serving.empty())
      return {"contested", Tone::kBad};
    if (bus == nullptr || (bus->report.state == BusState::kRunning && bus->report.stretch <= 1))
      return {};
    return bus->report.state == BusState::kRunning
               ? Span{"overloaded", Tone::kWarning}
               : Span{std::string(to_text(bus->report.state)), tone_of(bus->report.state)};
  }
  const auto* device = device_of(model, id);
  if (device == nullptr || device->report.state == DeviceState::kOnline) return {};
  return {std::string(to_text(device->report.state)), tone_of(device->report.state)};
}

std::vector<FrameLine> status_details(const StatusModel& model, const ChannelPath& id, UtcTime now,
                                      std::size_t columns) {
  if (!standby_group_of(id).empty()) return standby_details(model, id, columns);
  const auto* bus = bus_of(model, id);
  const auto* device = id.device.empty() ? nullptr : device_of(model, id);
  const UtcTime reported = device != nullptr ? device->reported_at
                           : bus != nullptr  ? bus->reported_at
                                             : UtcTime{};
  const std::string name = id.device.empty() ? "bus " + id.bus : id.bus + '/' + id.device;
  const std::string by = bus != nullptr ? fmt::format("  bridge {}", bus->bridge) : std::string{};
  std::vector<FrameLine> lines{
      full_line({{shown(name), Tone::kTitle},
                 {shown(fmt::format("{}  reported {} ago", by, age_text(reported, now)))}},
                columns, true)};
  if (id.device.empty() ? bus == nullptr : device == nullptr) {
    lines.push_back({{{"no status of it came yet", Tone::kFaint}}, false});
    return lines;
  }
  for (const StatusFact& fact : device != nullptr ? device_facts(*device, bus) : bus_facts(*bus))
    add_fact(lines, fact, columns);
  if (device == nullptr) {
    for (const StatusFact& fact : claim_facts(model, *bus)) add_fact(lines, fact, columns);
  }
  return lines;
}

}  // namespace fieldcast::cli
