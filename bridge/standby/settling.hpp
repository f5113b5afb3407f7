// Whether a bridge that starts has waited long enough for the other bridges of its domain to be
// found. Discovery alone takes up to 0.9 s; behind a discovery server, and with DDS Security on a
// busy machine, it takes longer: then it is known that somebody is there who has not spoken yet.
//
// Pure: no thread, no clock, no DDS; one owner. Nothing can fail.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast {

// What DDS knows of others who are not heard yet.
struct Finding {
  bool has_servers = false;     // discovery servers are configured
  bool server_answers = false;  // one of them, at least
  std::size_t unknown = 0;      // bridges that are found and have shown no writer, or say that they
                                // are of the group and are not heard there
  std::size_t silent = 0;       // bridges that have not said what they serve; one may be dead
};

class Settling {
 public:
  static constexpr Duration kLeast = std::chrono::seconds{1};
  // At most so long.
  static constexpr Duration kMost = std::chrono::seconds{3};
  // In a standby group, where one that takes over too early is a second master; for a discovery
  // server, and for who is not known yet.
  static constexpr Duration kMostInGroup = std::chrono::seconds{10};
  // In a group, after a discovery server has answered: 0.8 s were seen on a busy machine.
  static constexpr Duration kServer = std::chrono::seconds{2};
  // In a group, after the last one has spoken: until it is heard as a member, too.
  static constexpr Duration kMembers = std::chrono::milliseconds{300};

  Settling(bool in_group, Instant began) : in_group_(in_group), began_(began) {}

  // What is waited for; nothing: it is settled.
  [[nodiscard]] std::optional<std::string> waits_for(const Finding& finding, Instant now) {
    const Duration waited = now - began_;
    if (finding.server_answers) answered_ = std::min(answered_, now);
    if (finding.unknown + finding.silent > 0) silent_ = now;
    if (waited < kLeast) return "the other bridges";
    if (waited >= (in_group_ ? kMostInGroup : kMost)) return std::nullopt;
    if (in_group_ && finding.has_servers) {
      if (answered_ == kNever) return "a discovery server: none has answered";
      if (now - answered_ < kServer) return "what the discovery server knows";
    }
    if (finding.unknown > 0 || (finding.silent > 0 && waited < kMost))
      return std::to_string(finding.unknown + finding.silent) +
             " bridges that are there and have said nothing yet";
    // Who was late to speak is late to be heard as a member.
    const bool late = silent_ - began_ >= kLeast;
    if (in_group_ && late && now - silent_ < kMembers && finding.silent == 0)
      return "what they say of the group";
    return std::nullopt;
  }

 private:
  const bool in_group_;
  const Instant began_;
  Instant answered_ = kNever;  // when the first server did
  Instant silent_ = began_;    // when somebody was silent last
};

}  // namespace fieldcast
