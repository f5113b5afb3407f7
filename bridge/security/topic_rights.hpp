// Which role may write and read which topic: the table that permissions and documents are made of.
// Pure; values, any thread.
//
// A topic of bridge/dds/topics that has no row here is refused to everybody, and fails a test.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fieldcast::security {

enum class MemberRole : std::uint8_t { kBridge, kStation, kPlant, kStationReadonly };

struct RoleRow {
  MemberRole role;
  std::string_view word;  // of the command line, and of a certificate's OU
  std::string_view text;  // what it may do, for people
};
[[nodiscard]] std::span<const RoleRow> roles();
[[nodiscard]] std::string_view to_text(MemberRole role);
[[nodiscard]] std::optional<MemberRole> member_role_from(std::string_view word);

// A set of roles.
class Roles {
 public:
  constexpr Roles(std::initializer_list<MemberRole> roles) {
    for (const MemberRole role : roles) bits_ |= 1U << static_cast<unsigned>(role);
  }
  [[nodiscard]] constexpr bool has(MemberRole role) const {
    return (bits_ >> static_cast<unsigned>(role) & 1U) != 0;
  }

 private:
  unsigned bits_ = 0;
};

struct TopicRight {
  std::string_view topic;
  Roles writers;
  Roles readers;
  // What is written is for a bus: a writer may be held to some of them. Its partitions are then the
  // names, or the patterns, of these buses, and a bridge reads in the partition of each bus.
  bool by_bus = false;
};
[[nodiscard]] std::span<const TopicRight> topic_rights();

// The row of a topic, or null.
[[nodiscard]] const TopicRight* right_of(std::string_view topic);

// Documents of DDS Security are for the domains 0 to this one.
inline constexpr std::uint32_t kHighestDomain = 230;

// The longest name of a member, and the most patterns of buses that one may be held to.
inline constexpr std::size_t kMaxMemberName = 48;
inline constexpr std::size_t kMaxBusPatterns = 16;

// Somebody of the domain: a process, or all processes of one kind on a machine.
struct Member {
  MemberRole role = MemberRole::kStationReadonly;
  std::string name;                // 1 to kMaxMemberName of a-z A-Z 0-9 - _
  std::vector<std::string> buses;  // patterns that a plant is held to; empty: none
  friend bool operator==(const Member&, const Member&) = default;
};

// What is wrong with it, for people; empty: nothing.
[[nodiscard]] std::string fault_of(const Member& member);

}  // namespace fieldcast::security
