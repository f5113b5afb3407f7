// Decides whether a starting bridge has waited long enough to discover the other bridges of its
// domain. Discovery normally lasts up to 0.9 s. It lasts longer behind a discovery server, or with
// DDS Security on a busy machine. Then there are bridges that were found but have not announced
// anything.
//
// Pure: no thread, no clock, no DDS; one owner. Cannot fail.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast {

// What DDS reports of bridges that have not announced themselves yet.
struct Finding {
  bool has_servers = false;     // discovery servers are configured
  bool server_answers = false;  // at least one of them
  // Bridges found without a writer, and announced members without a message of the group.
  std::size_t unknown = 0;
  std::size_t silent = 0;  // bridges that have not announced what they serve; may be dead
};

class Settling {
 public:
  static constexpr Duration kLeast = std::chrono::seconds{1};
  // Upper limit outside a group.
  static constexpr Duration kMost = std::chrono::seconds{3};
  // Upper limit in a standby group, for a discovery server and for unknown bridges: a bridge that
  // takes over too early would be a second master.
  static constexpr Duration kMostInGroup = std::chrono::seconds{10};
  // In a group, the wait after the response of a discovery server; 0.8 s were measured under load.
  static constexpr Duration kServer = std::chrono::seconds{2};
  // In a group, the wait after the last announcement for the first message as a member.
  static constexpr Duration kMembers = std::chrono::milliseconds{300};

  Settling(bool in_group, Instant began) : in_group_(in_group), began_(began) {}

  // Returns what is waited for, or `std::nullopt` if settled.
  [[nodiscard]] std::optional<std::string> waits_for(const Finding& finding, Instant now) {
    const Duration waited = now - began_;
    if (finding.server_answers) answered_ = std::min(answered_, now);
    if (finding.unknown + finding.silent > 0) silent_ = now;
    if (waited < kLeast) return "the other bridges";
    if (waited >= (in_group_ ? kMostInGroup : kMost)) return std::nullopt;
    if (in_group_ && finding.has_servers) {
      if (answered_ == kNever) return "a discovery server: none has responded";
      if (now - answered_ < kServer) return "what the discovery server knows";
    }
    if (finding.unknown > 0 || (finding.silent > 0 && waited < kMost))
      return std::to_string(finding.unknown + finding.silent) +
             " bridges that are there and have said nothing yet";
    // A bridge that announced late also sends its first group message late.
    const bool late = silent_ - began_ >= kLeast;
    if (in_group_ && late && now - silent_ < kMembers && finding.silent == 0)
      return "what they say of the group";
    return std::nullopt;
  }

 private:
  const bool in_group_;
  const Instant began_;
  Instant answered_ = kNever;  // time of the first response
  Instant silent_ = began_;    // last time at which a bridge was silent
};

}  // namespace fieldcast
