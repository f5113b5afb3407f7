// The two XML documents of DDS Security (OMG formal/18-04-01, 9.4.1), before they are signed. Pure
// functions; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "bridge/security/topic_rights.hpp"
#include "core/base/time.hpp"

namespace fieldcast::security {

// What everything on the network is protected by.
enum class Protection : std::uint8_t {
  kEncrypt,  // nobody outside reads or changes it
  kSign,     // nobody outside changes it; everybody may read it
};

// For all domains and topics: nobody takes part without an identity, everything is protected by the
// keys of its participant. The content of what is by bus (commands) is protected once more by keys
// of its writer, which only bridges get: a station that reads samples cannot make commands of a
// plant, not even with a library of its own making. Protection of whole submessages would do the
// same for their sequence numbers, but Fast DDS 2.9.1 and Cyclone DDS 0.10.2 do not match with it.
[[nodiscard]] std::string governance_text(Protection protection);
// Whether it asks that whole messages are protected; ours do. Signed or not.
[[nodiscard]] bool protects_messages(std::string_view governance);

struct Grant {
  Member member;
  std::string subject;  // as RFC 2253 writes it
  UtcTime not_before, not_after;
};
// What the table of topics allows its role, in all domains; everything else is denied.
[[nodiscard]] std::string permissions_text(const Grant& grant);

// "2026-11-22T18:00:00", UTC.
[[nodiscard]] std::string xml_time(UtcTime time);

}  // namespace fieldcast::security
