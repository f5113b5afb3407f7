// The authority of a plant: the folder from which `fieldcast secure` creates members of its DDS
// domains. Keep it on a machine that is not a member, and in a backup.
//
//     DIR/identity-ca.pem, .key        signs identities and the list of revoked ones
//     DIR/permissions-ca.pem, .key     signs governance and permissions
//     DIR/governance.p7s, revoked.pem  the same for all members
//     DIR/issued/SERIAL.pem            every certificate that was ever issued
//     DIR/members/NAME/                the files of the member NAME: copy it to its machine
//
// Existing files are never overwritten, except by renew() and revoke(), which replace complete
// files. A failure, for example a full disk, leaves nothing half made. Only the owner can read
// keys. All functions throw SecurityError: for a folder that exists or is missing, a file that
// cannot be read or written, a file that others may change. One thread; one process at a time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridge/security/pki.hpp"
#include "bridge/security/subject.hpp"

namespace fieldcast::security {

inline constexpr Duration kDay = std::chrono::hours{24};
inline constexpr Duration kAuthorityLife = 3650 * kDay;
inline constexpr Duration kMemberLife = 365 * kDay;
inline constexpr Duration kWarnAhead = 30 * kDay;  // before an end of validity

struct MemberState {
  Member member;
  std::string folder;
  CertificateFacts certificate;
  bool revoked = false;
};

// The members, and human-readable remarks about their folder, one line each.
struct MemberList {
  std::vector<MemberState> members;
  // A file of a member, or a certificate issued to it, cannot be read.
  std::vector<std::string> faults;
  std::vector<std::string> strays;  // not a member: an archive, a copy, an empty folder
};

class Authority {
 public:
  // Creates the folder, which must not exist or must be empty.
  static Authority create(const std::string& folder, Protection protection, UtcTime now);
  explicit Authority(std::string folder);  // an existing one

  // Returns the folder created for the member. A name can be used only once, also after revocation.
  std::string add(const Member& member, UtcTime now, Duration life = kMemberLife);
  // Issues a new certificate and new permissions for the same key and subject. The folder may be
  // copied over the old one while programs run. They load it at their next start or reload.
  void renew(const std::string& name, UtcTime now, Duration life = kMemberLife);
  // Revokes all certificates ever issued to the member and writes the new list to the authority and
  // all members. Returns the files that could not be read or written; the others are done.
  std::vector<std::string> revoke(const std::string& name, UtcTime now);

  [[nodiscard]] MemberList members() const;
  [[nodiscard]] UtcTime not_after() const;  // of the authority: the earlier of its two ends

 private:
  struct Issued {
    std::vector<std::string> certificates;
    std::vector<std::string> faults;
  };
  [[nodiscard]] Issued issued_to(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> copy_revocations() const;
  [[nodiscard]] std::string path(std::string_view file) const;
  [[nodiscard]] std::string member_folder(const std::string& name) const;
  [[nodiscard]] MemberState state_of(const std::string& name) const;
  [[nodiscard]] Identity identities() const;
  [[nodiscard]] Identity permissions() const;
  [[nodiscard]] std::string issue_for(const Member& member, const std::string& key, UtcTime now,
                                      Duration life) const;
  [[nodiscard]] std::string place_of(const std::string& certificate) const;
  [[nodiscard]] Grant grant(const Member& member, const std::string& certificate) const;

  std::string folder_;
};

struct MemberCheck {
  std::vector<std::string> faults;    // the member is refused
  std::vector<std::string> warnings;  // the member will soon be refused
};
[[nodiscard]] MemberCheck check_member(const std::string& folder, UtcTime now);
// Returns the faults of an authority's folder and its own files, one human-readable line each.
[[nodiscard]] std::vector<std::string> authority_faults(const std::string& folder);
// The same for a program's folder. A bridge needs a bridge's identity; other programs another role.
[[nodiscard]] MemberCheck check_program(const std::string& folder, bool is_bridge, UtcTime now);

// Validity end of the certificate in a member's folder; `std::nullopt` if it cannot be read.
[[nodiscard]] std::optional<UtcTime> end_of_member(const std::string& folder);

// "2027-11-22".
[[nodiscard]] std::string date_text(UtcTime time);

}  // namespace fieldcast::security
