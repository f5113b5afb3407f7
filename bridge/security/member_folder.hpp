// The folder of one member: its identity, its permissions, and the certificates to check others.
// `fieldcast secure add` creates it; `dds: { security: DIR }` names it. Functions on files; any
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

// Lines "role: plant", "name: mes-1", "bus: press-*". The signed permissions decide what a member
// may do; this text informs its own programs.
[[nodiscard]] std::string member_text(const Member& member);
[[nodiscard]] tl::expected<Member, std::string> member_from(std::string_view text);

// Returns the member of the folder. Fails with a human-readable text if the folder or a file is
// missing, or if access rights are unsafe: only the owner, and a group for reading, may read a key;
// only the owner may change a file or the folder.
[[nodiscard]] tl::expected<Member, std::string> read_member(const std::string& folder);

// "file:///etc/fieldcast/security/identity.pem", the form that DDS requires.
[[nodiscard]] std::string file_uri(const std::string& folder, std::string_view file);

}  // namespace fieldcast::security
