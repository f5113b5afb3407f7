// The authority of a plant: the folder from which `fieldcast secure` makes members of its DDS
// domains. It belongs on a machine that is not a member, and into a backup.
//
//     DIR/identity-ca.pem, .key        signs identities, and the list of those that are revoked
//     DIR/permissions-ca.pem, .key     signs governance and permissions
//     DIR/governance.p7s, revoked.pem  the same for all members
//     DIR/issued/SERIAL.pem            every certificate that was ever given out
//     DIR/members/NAME/                what the member NAME gets: copy it to its machine
//
// Nothing that is there is written over, except by renew() and revoke(), which replace whole files.
// What fails, on a full disk for instance, leaves nothing half made. Keys are readable for their
// owner only. All throw SecurityError: a folder that is there, or is not, a file that cannot be
// read or written, one that others may change. One thread; one process at a time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridge/security/documents.hpp"
#include "bridge/security/pki.hpp"

namespace fieldcast::security {

inline constexpr Duration kDay = std::chrono::hours{24};
inline constexpr Duration kAuthorityLife = 3650 * kDay;
inline constexpr Duration kMemberLife = 365 * kDay;
inline constexpr Duration kWarnAhead = 30 * kDay;  // of an end

struct MemberState {
  Member member;
  std::string folder;
  CertificateFacts certificate;
  bool revoked = false;
};

// What is in the folder of the members, and what is to be said of it: each a line for people.
struct MemberList {
  std::vector<MemberState> members;  // by name
  std::vector<std::string> faults;   // a file of a member, or one issued to it, cannot be read
  std::vector<std::string> strays;   // no member: an archive, a copy, an empty folder
};

class Authority {
 public:
  // Makes the folder, which must not be there, or be empty.
  static Authority create(const std::string& folder, Protection protection, UtcTime now);
  explicit Authority(std::string folder);  // one that is there

  // The folder that was made for it. A name is given once, also when it is revoked.
  std::string add(const Member& member, UtcTime now, Duration life = kMemberLife);
  // A new certificate and new permissions for the same key and subject. The folder may be copied
  // over the old one while programs run: they go on, and take the new files when they start again,
  // or when a bridge is reloaded.
  void renew(const std::string& name, UtcTime now, Duration life = kMemberLife);
  // All certificates that were ever issued to it, whether its folder is there or not. Writes the
  // list anew, also into the folders of all members. Says which files could not be read or written;
  // the others are done.
  std::vector<std::string> revoke(const std::string& name, UtcTime now);

  [[nodiscard]] MemberList members() const;
  [[nodiscard]] UtcTime not_after() const;  // of the authority itself, the sooner of its two

 private:
  struct Issued {
    std::vector<std::string> certificates;
    std::vector<std::string> faults;  // files that could not be read
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
  // The place of a certificate in the folder of all that were issued.
  [[nodiscard]] std::string place_of(const std::string& certificate) const;
  [[nodiscard]] Grant grant(const Member& member, const std::string& certificate) const;

  std::string folder_;
};

// What is to be said of a member's folder: each a line for people.
struct MemberCheck {
  std::vector<std::string> faults;    // it will not be let in
  std::vector<std::string> warnings;  // it will soon not be let in
};
[[nodiscard]] MemberCheck check_member(const std::string& folder, UtcTime now);
// What is wrong with the folder of an authority and its own files: each a line for people.
[[nodiscard]] std::vector<std::string> authority_faults(const std::string& folder);
// The same of the folder that a program was given. A bridge needs the identity of a bridge, and all
// others need another one.
[[nodiscard]] MemberCheck check_program(const std::string& folder, bool is_bridge, UtcTime now);

// When the certificate in a member's folder ends; nothing: it cannot be read.
[[nodiscard]] std::optional<UtcTime> end_of_member(const std::string& folder);

// "2027-11-22".
[[nodiscard]] std::string date_text(UtcTime time);

}  // namespace fieldcast::security
