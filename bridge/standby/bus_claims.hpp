// Which bridge serves a bus when several of one domain name it: each tells the others what it wants
// and what it serves (topic fieldcast/Bridge), and each decides by the same rule. Pure; one owner.
//
// The rule: a bridge that serves a bus keeps it, whatever others claim: a claim can be forged.
// One that waits gives way to a bridge that serves; of two that wait, the one that has wanted the
// bus for longer goes first; of two that began at the same instant, the one with the smaller
// identity. Claims that only wait count for kMostUnserved: a bridge that has seen nobody serve the
// bus for so long serves it. Two that both served before they met both go on, and the bus is
// contested(). So clocks that differ change who is first of several that begin together, never who
// goes on. Bridges of one standby group are no rivals: the group's election says which of them
// serves.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

struct BusClaim {
  UtcTime since;         // when its bridge first wanted it
  bool serving = false;  // else it waits for another bridge
  friend bool operator==(const BusClaim&, const BusClaim&) = default;
};

// What a bridge tells the others.
struct BridgeClaims {
  std::string bridge;   // its name
  std::string host;     // for people
  std::string process;  // see process_identity.hpp
  UtcTime since;        // when it joined the domain
  std::map<std::string, BusClaim> buses;
  std::string group{};  // its standby group; empty: none
  std::int32_t strength = 0;
  friend bool operator==(const BridgeClaims&, const BridgeClaims&) = default;
};

class BusClaims {
 public:
  // A bridge that waits for others which only wait, too, serves the bus after this time.
  static constexpr Duration kMostUnserved = std::chrono::seconds{5};

  // `id`: of this bridge in DDS, unique in the domain. Others are told apart by theirs.
  explicit BusClaims(std::string id = {}) : id_(std::move(id)) {}
  void set_id(std::string id) { id_ = std::move(id); }
  void set_group(std::string group) { group_ = std::move(group); }
  // While it stands by, another one of its group serves.
  void set_standing_by(bool standing_by) { standing_by_ = standing_by; }

  // ---- the others

  void receive(const std::string& id, BridgeClaims claims);  // in place of what it said before
  // Its lease is over, or it is alive again. No effect for a bridge that told nothing yet.
  void set_alive(const std::string& id, bool alive);
  void forget(const std::string& id);
  // Others whose process runs where this one does, for set_alive().
  [[nodiscard]] std::map<std::string, std::string> processes() const;

  // How many of the group there are beside these.
  [[nodiscard]] std::size_t members_beside(const std::vector<std::string>& bridges) const;

  // Another member of the group with the name of this one; `own`: what this one tells. Of both, the
  // one that serves goes first, then the one that has been there for longer.
  struct Namesake {
    BridgeClaims claims;
    bool goes_first = false;
  };
  [[nodiscard]] std::optional<Namesake> namesake(const BridgeClaims& own) const;

  // ---- this bridge

  // Wants these buses, from now on those that are new. One it does not want any more is free.
  void want(const std::vector<std::string>& buses, UtcTime now);
  // The bridge that keeps this one from serving a bus, and what it said. Of a bus that this bridge
  // serves: one that serves it as well. Empty if there is none. REQUIRES: the bus is wanted.
  [[nodiscard]] std::optional<BridgeClaims> rival(const std::string& bus) const;
  // Decides for each wanted bus whether this bridge serves it. Returns true if something changed:
  // the caller announces it. Call it repeatedly, because kMostUnserved depends on the time.
  bool decide(Instant now);
  [[nodiscard]] const std::map<std::string, BusClaim>& buses() const { return own_; }
  [[nodiscard]] bool serves(const std::string& bus) const;
  // The buses that this bridge serves and another one claims to serve as well.
  [[nodiscard]] std::set<std::string> contested() const;

 private:
  struct Other {
    BridgeClaims claims;
    bool alive = true;
  };
  [[nodiscard]] bool is_rival(const Other& other) const {
    return other.alive && (group_.empty() || other.claims.group != group_);
  }
  std::string id_, group_;
  bool standing_by_ = false;
  std::map<std::string, BusClaim> own_;
  std::map<std::string, Instant> unserved_;  // since when all that want the bus wait
  std::map<std::string, Other> others_;
};

}  // namespace fieldcast
