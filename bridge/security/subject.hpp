// The subject name of an identity: O=Fieldcast, OU=its role, CN=its name and a number.
//
// DDS Security makes the first six bytes of a participant's GUID of the SHA-256 of the subject
// (formal/18-04-01, 9.3.3), and both sides of a handshake check that. So the GUID of who wrote
// something tells the subject, and who has the smaller GUID begins the handshake. Fast DDS 2.9 must
// not begin one with Cyclone DDS (eProsima/Fast-DDS #3802): the number is chosen such that bridges
// are always above stations and plants. Pure; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/security/topic_rights.hpp"

namespace fieldcast::security {

struct Subject {
  MemberRole role = MemberRole::kStationReadonly;
  std::string name;
  std::uint32_t number = 1;
  friend bool operator==(const Subject&, const Subject&) = default;

  [[nodiscard]] std::string common_name() const;  // "mes-1.2"
  [[nodiscard]] std::string text() const;         // "plant mes-1", for logs and the audit
};

// The first number with which the member begins, or leaves the beginning, as it must.
[[nodiscard]] Subject subject_for(const Member& member);

// Of the slashed text of a certificate or an identity token, "/O=Fieldcast/OU=plant/CN=mes-1.2";
// nothing for one that is not of Fieldcast's authority.
[[nodiscard]] std::optional<Subject> subject_from(std::string_view slashed);

// The name in DER, as it stands in the certificate.
[[nodiscard]] std::string der_of(const Subject& subject);

// What the first six bytes of its participants' GUIDs are.
using GuidStart = std::array<std::uint8_t, 6>;
[[nodiscard]] GuidStart guid_start(const Subject& subject);

}  // namespace fieldcast::security
