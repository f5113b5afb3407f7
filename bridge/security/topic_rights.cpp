#include "bridge/security/topic_rights.hpp"

#include <algorithm>

namespace fieldcast::security {
namespace {

using enum MemberRole;

constexpr RoleRow kRoles[] = {
    {kBridge, "bridge", "publishes its buses, receives commands and interests"},
    {kStation, "station", "reads, and declares interests"},
    {kPlant, "plant", "reads, declares interests, commands and acts on alarms"},
    {kStationReadonly, "station-readonly", "reads"},
};

constexpr Roles kBridges{kBridge};
constexpr Roles kAllStations{kStation, kPlant, kStationReadonly};
constexpr Roles kEverybody{kBridge, kStation, kPlant, kStationReadonly};

constexpr TopicRight kRights[] = {
    // A bridge reads data of other bridges to be able to stand by for them.
    {"fieldcast/Sample", kBridges, kAllStations},
    {"fieldcast/SampleBlock", kBridges, kEverybody},
    {"fieldcast/Channel", kBridges, kAllStations},
    {"fieldcast/CatalogueBlock", kBridges, kAllStations},
    // A request to repeat the last values, which every reader of blocks may need.
    {"fieldcast/SnapshotRequest", kAllStations, kBridges},
    {"fieldcast/BusStatus", kBridges, kAllStations},
    {"fieldcast/DeviceStatus", kBridges, kEverybody},
    {"fieldcast/ProgramSession", kBridges, kAllStations},
    {"fieldcast/ReadPlan", kBridges, kAllStations},
    {"fieldcast/Alarm", kBridges, kAllStations},
    {"fieldcast/AlarmStatus", kBridges, kEverybody},
    {"fieldcast/Bridge", kBridges, kEverybody},
    {"fieldcast/Interest", {kStation, kPlant}, kBridges},
    {"fieldcast/Command", {kPlant}, kBridges, true},
    {"fieldcast/AlarmAction", {kPlant}, kBridges, true},
    {"fieldcast/CommandResult", kBridges, {kBridge, kPlant}},
    {"fieldcast/Standby", kBridges, kEverybody},
    {"fieldcast/StandbyNote", kBridges, kBridges},
    {"fieldcast/StandbyRequest", {kPlant}, kBridges},
};

bool is_name(std::string_view text, std::string_view more) {
  return !text.empty() && std::ranges::all_of(text, [more](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           more.find(c) != std::string_view::npos;
  });
}

}  // namespace

std::span<const RoleRow> roles() { return kRoles; }

std::string_view to_text(MemberRole role) {
  return std::ranges::find(kRoles, role, &RoleRow::role)->word;
}

std::optional<MemberRole> member_role_from(std::string_view word) {
  const auto* const found = std::ranges::find(kRoles, word, &RoleRow::word);
  return found == std::end(kRoles) ? std::nullopt : std::optional(found->role);
}

std::span<const TopicRight> topic_rights() { return kRights; }

const TopicRight* right_of(std::string_view topic) {
  const auto* const found = std::ranges::find(kRights, topic, &TopicRight::topic);
  return found == std::end(kRights) ? nullptr : found;
}

std::string fault_of(const Member& member) {
  if (!is_name(member.name, "-_") || member.name.size() > kMaxMemberName) {
    return "the name of a member is 1 to " + std::to_string(kMaxMemberName) +
           " letters, digits, '-' and '_'";
  }
  if (member.buses.empty()) return {};
  if (member.role != kPlant) {
    return "only a plant can be held to buses; " + std::string(to_text(member.role)) +
           " members take part in all of them";
  }
  if (member.buses.size() > kMaxBusPatterns)
    return "at most " + std::to_string(kMaxBusPatterns) + " patterns of buses";
  for (const std::string& bus : member.buses) {
    if (!is_name(bus, "-_.*"))
      return "'" + bus + "' is no pattern of buses: letters, digits, '-', '_', '.' and '*'";
  }
  return {};
}

}  // namespace fieldcast::security
