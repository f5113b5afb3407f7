// The folder of one member, as `fieldcast secure add` makes it and `dds: { security: DIR }` names
// it: its identity, its permissions, and what it needs to check others. Functions of files; any
// thread.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "bridge/security/topic_rights.hpp"

namespace fieldcast::security {

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

// Lines "role: plant", "name: mes-1", "bus: press-*". What a member may do is said by its signed
// permissions; this tells its own programs what they may try.
[[nodiscard]] std::string member_text(const Member& member);
[[nodiscard]] tl::expected<Member, std::string> member_from(std::string_view text);

// Who the folder makes a program. The fault is for people: no such folder, a file is missing, a key
// that others than the owner (and a group that may only read) can read, a file or the folder itself
// that others may change.
[[nodiscard]] tl::expected<Member, std::string> read_member(const std::string& folder);

// "file:///etc/fieldcast/security/identity.pem", as DDS wants it.
[[nodiscard]] std::string file_uri(const std::string& folder, std::string_view file);

}  // namespace fieldcast::security
