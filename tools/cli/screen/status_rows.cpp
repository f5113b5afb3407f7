#include "tools/cli/screen/status_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/screen/channel_rows.hpp"
#include "tools/cli/screen/list_control.hpp"
#include "tools/cli/text/cell_text.hpp"
#include "tools/cli/view/status/status_facts.hpp"
#include "tools/cli/view/status/status_view.hpp"

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

namespace {

constexpr std::string_view kGroup = "group ";

struct StatusGroup {
  ListRow head;
  ListRows members;
  bool chosen = false;
};

class StatusGroups {
 public:
  explicit StatusGroups(const StatusChoice& choice)
      : choice_(choice), words_(filter_words(choice.filter)) {}

  // `says`: text for the filter.
  void add_head(const ChannelPath& id, Rank rank, const std::string& says) {
    StatusGroup& group = group_of(id);
    group.head.rank = std::min(group.head.rank, rank);
    group.chosen |= is_chosen(rank, says);
  }
  void add_member(const ChannelPath& id, Rank rank, const std::string& says) {
    StatusGroup& group = group_of(id);
    ++group.head.members;
    group.head.good += rank == Rank::kGood ? 1 : 0;
    group.head.bad += rank == Rank::kBad ? 1 : 0;
    group.head.rank = std::min(group.head.rank, rank);
    if (!is_chosen(rank, says)) return;
    group.members.push_back({.id = id, .rank = rank});
    group.chosen = true;
  }

  [[nodiscard]] ListRows rows(const RowList& list) {
    std::vector<StatusGroup> ordered;
    for (auto& [name, group] : groups_) {
      if (group.chosen) ordered.push_back(std::move(group));
    }
    if (!choice_.by_name)
      std::ranges::stable_sort(ordered, {},
                               [](const StatusGroup& group) { return group.head.rank; });
    ListRows rows;
    for (StatusGroup& group : ordered) {
      group.head.folded = list.is_folded(group.head.id);
      rows.push_back(group.head);
      if (group.head.folded) continue;
      if (!choice_.by_name) std::ranges::stable_sort(group.members, {}, &ListRow::rank);
      rows.insert(rows.end(), group.members.begin(), group.members.end());
    }
    return rows;
  }

 private:
  StatusGroup& group_of(const ChannelPath& id) {
    // Standby groups are sorted before buses.
    StatusGroup& group = groups_[{standby_group_of(id).empty(), id.bus}];
    group.head.id = {id.bus, {}, {}};
    return group;
  }
  [[nodiscard]] bool is_chosen(Rank rank, const std::string& says) const {
    return (!choice_.bad_only || rank != Rank::kGood) && has_words(says, words_);
  }

  const StatusChoice& choice_;
  const std::vector<std::string> words_;
  std::map<std::pair<bool, std::string>, StatusGroup> groups_;
};

std::string searched(const std::string& name, std::string_view state, const CauseCounts& causes) {
  return name + ' ' + std::string(state) + ' ' + causes_text(causes);
}

}  // namespace

Rank rank_of(const StationBusStatus& bus) {
  if (bus.report.state == BusState::kClosed) return Rank::kBad;
  return bus.report.state == BusState::kRunning && bus.report.stretch <= 1 ? Rank::kGood
                                                                           : Rank::kUncertain;
}

Rank rank_of(const StationDeviceStatus& device) {
  switch (device.report.state) {
    case DeviceState::kOffline: return Rank::kBad;
    case DeviceState::kDegraded: return Rank::kUncertain;
    case DeviceState::kUnknown: return Rank::kUnread;
    case DeviceState::kOnline: break;
  }
  return Rank::kGood;
}

Rank rank_of(const StandbyMessage& member) {
  switch (member.member.role) {
    case StandbyRole::kMaster: return Rank::kGood;
    case StandbyRole::kWaiting:
      return member.member.not_ready.empty() ? Rank::kGood : Rank::kUncertain;
    default: return Rank::kUncertain;
  }
}

ChannelPath group_row_id(const std::string& group, const std::string& bridge) {
  return {std::string(kGroup) + group, bridge, {}};
}

std::string standby_group_of(const ChannelPath& id) {
  return id.bus.starts_with(kGroup) ? id.bus.substr(kGroup.size()) : std::string{};
}

const StandbyMessage* member_of(const StatusModel& model, const ChannelPath& id) {
  const auto found = model.members.find({standby_group_of(id), id.device});
  return found == model.members.end() ? nullptr : &found->second;
}

ListRows status_rows(const StatusModel& model, const StatusChoice& choice, const RowList& list) {
  StatusGroups groups(choice);
  for (const auto& [name, bus] : model.buses) {
    const bool contested = !claimants_of(model, bus).serving.empty();
    groups.add_head(
        {name, {}, {}}, contested ? Rank::kBad : rank_of(bus),
        searched(name, to_text(bus.report.state), bus.causes) + (contested ? " contested" : ""));
  }
  for (const auto& [key, device] : model.devices)
    groups.add_member(
        {key.first, key.second, {}}, rank_of(device),
        searched(key.first + '/' + key.second, to_text(device.report.state), device.causes));
  for (const auto& [key, member] : model.members) {
    const ChannelPath id = group_row_id(key.first, key.second);
    const bool served = master_of(model.members, key.first) != nullptr;
    groups.add_head({id.bus, {}, {}}, served ? Rank::kGood : Rank::kBad,
                    served ? id.bus : id.bus + " no master");
    groups.add_member(
        id, rank_of(member),
        id.bus + '/' + id.device + ' ' + role_text(member) + ' ' + member.member.not_ready);
  }
  return groups.rows(list);
}

}  // namespace fieldcast::cli
