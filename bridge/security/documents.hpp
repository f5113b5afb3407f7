// The two XML documents of DDS Security (OMG formal/18-04-01, 9.4.1), unsigned. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "bridge/security/topic_rights.hpp"
#include "core/base/time.hpp"

namespace fieldcast::security {

// Protection of all messages on the network.
enum class Protection : std::uint8_t {
  kEncrypt,  // outsiders can neither read nor change messages
  kSign,     // outsiders cannot change messages, but can read them
};

// Applies to all domains and topics: a participant needs an identity, and its keys protect
// everything it sends. The content of topics by bus (commands) is also protected with keys of the
// writer, which only bridges receive. A station that may read samples therefore cannot forge
// commands, not even with its own DDS library. Protection of whole submessages would also cover
// their sequence numbers, but Fast DDS 2.9.1 and Cyclone DDS 0.10.2 do not match with it.
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
