// The subject name of an identity: O=Fieldcast, OU=its role, CN=its name and a number. In DDS
// Security, the first six bytes of a participant's GUID come from the SHA-256 of the subject
// (formal/18-04-01, 9.3.3), so the GUID of a writer identifies the subject. The participant with
// the smaller GUID begins the handshake, which Fast DDS 2.9 must not do with Cyclone DDS
// (eProsima/Fast-DDS #3802). So the number gives bridges a greater GUID than stations and plants.
// Pure; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/security/member_folder.hpp"
#include "core/base/time.hpp"

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

// Parses "/O=Fieldcast/OU=plant/CN=mes-1.2"; empty for a subject of another authority.
[[nodiscard]] std::optional<Subject> subject_from(std::string_view slashed);

[[nodiscard]] std::string der_of(const Subject& subject);

// First six bytes of the GUIDs of its participants.
using GuidStart = std::array<std::uint8_t, 6>;
[[nodiscard]] GuidStart guid_start(const Subject& subject);

// The two XML documents of DDS Security (OMG formal/18-04-01, 9.4.1), unsigned. Pure.

// Protection of all messages on the network.
enum class Protection : std::uint8_t {
  kEncrypt,  // outsiders can neither read nor change messages
  kSign,     // outsiders cannot change messages, but can read them
};

// Applies to all domains and topics: a participant needs an identity, and its keys protect
// everything it sends. The content of topics by bus (commands) is also protected with keys of the
// writer, which only bridges receive: a station that may read samples cannot forge commands. Fast
// DDS 2.9.1 and Cyclone DDS 0.10.2 do not match with protection of whole submessages.
[[nodiscard]] std::string governance_text(Protection protection);
// Returns true if the document, signed or not, requires protection of whole messages.
[[nodiscard]] bool protects_messages(std::string_view governance);

struct Grant {
  Member member;
  std::string subject;  // in the form of RFC 2253
  UtcTime not_before, not_after;
};
// Allows what the table of topics allows for the role, in all domains; denies everything else.
[[nodiscard]] std::string permissions_text(const Grant& grant);

// "2026-11-22T18:00:00", UTC.
[[nodiscard]] std::string xml_time(UtcTime time);

}  // namespace fieldcast::security
