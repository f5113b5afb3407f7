// The topics that each role may write and read; source of permissions and documents. A topic of
// bridge/dds/topics without a row is denied, and a test fails. Pure; values, any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace fieldcast::security {

enum class MemberRole : std::uint8_t { kBridge, kStation, kPlant, kStationReadonly, kEngineer };

struct RoleRow {
  MemberRole role;
  std::string_view word;  // on the command line, and in a certificate's OU
  std::string_view text;  // human-readable description of the rights
};
[[nodiscard]] std::span<const RoleRow> roles();
[[nodiscard]] std::string_view to_text(MemberRole role);
[[nodiscard]] std::optional<MemberRole> member_role_from(std::string_view word);

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
  // The data is for a bus, and a writer may be limited to certain buses. Its partitions are then
  // the names or patterns of these buses; a bridge reads in the partition of each bus.
  bool by_bus = false;
};
[[nodiscard]] std::span<const TopicRight> topic_rights();

// Returns null if the topic has no row.
[[nodiscard]] const TopicRight* right_of(std::string_view topic);

// Documents of DDS Security apply to the domains 0 to this one.
inline constexpr std::uint32_t kHighestDomain = 230;

inline constexpr std::size_t kMaxMemberName = 48;
inline constexpr std::size_t kMaxBusPatterns = 16;

// A member of the domain: one process, or all processes of one kind on a machine.
struct Member {
  MemberRole role = MemberRole::kStationReadonly;
  std::string name;                // 1 to kMaxMemberName of a-z A-Z 0-9 - _
  std::vector<std::string> buses;  // patterns that a plant is limited to; empty: no limit
  friend bool operator==(const Member&, const Member&) = default;
};

// Returns a human-readable fault, or an empty text.
[[nodiscard]] std::string fault_of(const Member& member);

// The folder of one member: its identity, its permissions, and the certificates to check others.
// `fieldcast secure add` creates it; `dds: { security: DIR }` names it. Any thread.
inline constexpr std::string_view kIdentityCa = "identity-ca.pem";
inline constexpr std::string_view kPermissionsCa = "permissions-ca.pem";
inline constexpr std::string_view kGovernance = "governance.p7s";
inline constexpr std::string_view kRevoked = "revoked.pem";  // certificates, as a CRL
inline constexpr std::string_view kIdentity = "identity.pem";
inline constexpr std::string_view kIdentityKey = "identity.key";
inline constexpr std::string_view kPermissions = "permissions.p7s";
inline constexpr std::string_view kMember = "member.txt";  // role, name and buses, for programs
inline constexpr std::string_view kMemberFiles[] = {kIdentityCa,  kPermissionsCa, kGovernance,
                                                    kRevoked,     kIdentity,      kIdentityKey,
                                                    kPermissions, kMember};

// Lines "role: plant", "name: mes-1", "bus: press-*". The signed permissions decide what a member
// may do; this text informs its own programs.
[[nodiscard]] std::string member_text(const Member& member);
[[nodiscard]] tl::expected<Member, std::string> member_from(std::string_view text);

// The member of the folder. Fails with a text if a file is missing or access rights are unsafe:
// only the owner, and a group for reading, may read a key; only the owner may change files.
[[nodiscard]] tl::expected<Member, std::string> read_member(const std::string& folder);

// "file:///etc/fieldcast/security/identity.pem", the form that DDS requires.
[[nodiscard]] std::string file_uri(const std::string& folder, std::string_view file);

}  // namespace fieldcast::security
