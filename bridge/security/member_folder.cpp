#include "bridge/security/member_folder.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::security {

namespace {

using enum MemberRole;

constexpr RoleRow kRoles[] = {
    {kBridge, "bridge", "publishes its buses, receives commands and interests"},
    {kStation, "station", "reads, and declares interests"},
    {kPlant, "plant", "reads, declares interests, commands and acts on alarms"},
    {kStationReadonly, "station-readonly", "reads"},
    {kEngineer, "engineer", "as a plant, and changes the configuration of bridges"},
};

constexpr Roles kBridges{kBridge};
constexpr Roles kCommanders{kPlant, kEngineer};
constexpr Roles kAllStations{kStation, kPlant, kStationReadonly, kEngineer};
constexpr Roles kEverybody{kBridge, kStation, kPlant, kStationReadonly, kEngineer};

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
    {"fieldcast/ProgramRequest", kBridges, kAllStations},
    {"fieldcast/DeviceDescription", kBridges, kAllStations},
    {"fieldcast/ReadPlan", kBridges, kAllStations},
    {"fieldcast/Alarm", kBridges, kAllStations},
    {"fieldcast/AlarmStatus", kBridges, kEverybody},
    {"fieldcast/Bridge", kBridges, kEverybody},
    // Not read by stations: none may receive what another station writes.
    {"fieldcast/Interest", {kStation, kPlant, kEngineer}, kBridges},
    {"fieldcast/Command", kCommanders, kBridges, true},
    {"fieldcast/AlarmAction", kCommanders, kBridges, true},
    {"fieldcast/CommandResult", kBridges, {kBridge, kPlant, kEngineer}},
    {"fieldcast/Standby", kBridges, kEverybody},
    {"fieldcast/StandbyNote", kBridges, kBridges},
    {"fieldcast/StandbyRequest", kCommanders, kBridges},
    {"fieldcast/Audit", kBridges, kAllStations},
    {"fieldcast/HistoryRequest", kAllStations, kBridges},
    {"fieldcast/HistoryBlock", kBridges, kAllStations},
    {"fieldcast/ConfigurationRequest", {kEngineer}, kBridges},
    {"fieldcast/ConfigurationReply", kBridges, {kEngineer}},
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

namespace {

constexpr std::size_t kMaxText = 8192;
constexpr mode_t kNotForAll = S_IWGRP | S_IXGRP | S_IRWXO;
constexpr mode_t kChange = S_IWGRP | S_IWOTH;  // by other users

tl::unexpected<std::string> fault(std::string text) { return tl::unexpected(std::move(text)); }

}  // namespace

std::string member_text(const Member& member) {
  std::string text = "role: " + std::string(to_text(member.role)) + "\nname: " + member.name + '\n';
  for (const std::string& bus : member.buses) text += "bus: " + bus + '\n';
  return text;
}

tl::expected<Member, std::string> member_from(std::string_view text) {
  Member member;
  bool has_role = false;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    const auto colon = line.find(": ");
    if (colon == std::string::npos) return fault("a line is not 'word: value'");
    const std::string word = line.substr(0, colon), value = line.substr(colon + 2);
    if (word == "role") {
      const auto role = member_role_from(value);
      if (!role) return fault("the role is unknown");
      member.role = *role;
      has_role = true;
    } else if (word == "name") {
      member.name = value;
    } else if (word == "bus") {
      member.buses.push_back(value);
    } else {
      return fault("a word is unknown");
    }
  }
  if (!has_role) return fault("the role is missing");
  if (const std::string wrong = fault_of(member); !wrong.empty()) return fault(wrong);
  return member;
}

namespace {

// Returns the reason if access rights hide the path from this user.
std::optional<std::string> hidden(const std::string& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) == 0 || errno != EACCES) return std::nullopt;
  return path + " cannot be read by this user: " + errno_text(EACCES);
}

// Checks that a file of a member exists and that its access rights are safe.
std::optional<std::string> fault_of_file(const std::string& folder, std::string_view file) {
  const std::string path = folder + '/' + std::string(file);
  if (auto why = hidden(path)) return why;
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0 || !S_ISREG(found.st_mode)) {
    const bool authority = ::stat((folder + "/members").c_str(), &found) == 0;
    return authority ? folder + " is an authority's folder, not a member's: name " + folder +
                           "/members/NAME, or a copy of it"
                     : folder + " is no folder of a member: " + std::string(file) + " is missing";
  }
  if (file == kIdentityKey && (found.st_mode & kNotForAll) != 0)
    return path + " is open to others than its owner; chmod 600 " + path;
  if ((found.st_mode & kChange) != 0) return path + ": others may change it; chmod go-w " + path;
  if (!std::ifstream(path)) return path + " cannot be read by this user";
  return std::nullopt;
}

}  // namespace

tl::expected<Member, std::string> read_member(const std::string& folder) {
  if (auto why = hidden(folder)) return fault(*std::move(why));
  struct stat found {};
  if (::stat(folder.c_str(), &found) != 0 || !S_ISDIR(found.st_mode)) {
    return fault("there is no folder " + folder +
                 "; fieldcast secure add makes one for each member");
  }
  if ((found.st_mode & kChange) != 0)
    return fault(folder + ": others may change it; chmod go-w " + folder);
  for (const std::string_view file : kMemberFiles) {
    if (auto wrong = fault_of_file(folder, file)) return fault(*std::move(wrong));
  }
  std::ifstream in(folder + '/' + std::string(kMember));
  std::string text(kMaxText, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  auto member = member_from(text);
  if (!member) return fault(folder + '/' + std::string(kMember) + ": " + member.error());
  return member;
}

std::string file_uri(const std::string& folder, std::string_view file) {
  return "file://" + (std::filesystem::absolute(folder) / file).lexically_normal().string();
}

}  // namespace fieldcast::security
