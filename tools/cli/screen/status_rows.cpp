#include "tools/cli/screen/status_rows.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "tools/cli/screen/channel_rows.hpp"
#include "tools/cli/view/status/claims_view.hpp"
#include "tools/cli/view/status/standby_facts.hpp"

namespace fieldcast::cli {
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
