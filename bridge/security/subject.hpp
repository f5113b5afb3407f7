// The subject name of an identity: O=Fieldcast, OU=its role, CN=its name and a number.
//
// In DDS Security, the first six bytes of a participant's GUID come from the SHA-256 of the subject
// (formal/18-04-01, 9.3.3); both sides of a handshake check that. The GUID of a writer therefore
// identifies the subject. The participant with the smaller GUID begins the handshake. Fast DDS 2.9
// must not begin one with Cyclone DDS (eProsima/Fast-DDS #3802). The number is therefore chosen
// such that bridges always have a greater GUID than stations and plants. Pure; any thread.
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

// Uses the first number with which the GUID is in the half required for the role.
[[nodiscard]] Subject subject_for(const Member& member);

// Parses the slashed text of a certificate or an identity token,
// "/O=Fieldcast/OU=plant/CN=mes-1.2". Returns `std::nullopt` for a subject of another authority.
[[nodiscard]] std::optional<Subject> subject_from(std::string_view slashed);

[[nodiscard]] std::string der_of(const Subject& subject);

// First six bytes of the GUIDs of its participants.
using GuidStart = std::array<std::uint8_t, 6>;
[[nodiscard]] GuidStart guid_start(const Subject& subject);

}  // namespace fieldcast::security
