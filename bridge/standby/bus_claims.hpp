// Decides which bridge serves a bus when several bridges of one domain want it. Each bridge
// announces what it wants and what it serves (topic fieldcast/Bridge), and all decide by the same
// rule. Pure; one owner.
//
// - A bridge that serves a bus keeps it, whatever others claim, because a claim can be forged.
// - A waiting bridge yields to a bridge that serves the bus.
// - Of waiting bridges, the one that has wanted the bus longest has priority; at the same instant,
//   the one with the smaller identity.
// - If all bridges only wait for a bus, a bridge serves it after kMostUnserved.
// - If two bridges served a bus before they discovered each other, both continue, and the bus is
//   contested().
//
// Different clocks therefore affect only the order of bridges that start together, never which
// bridge continues. Bridges of one standby group are no rivals: the election of the group decides
// which of them serves.
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
  UtcTime since;         // when its bridge first wanted the bus
  bool serving = false;  // false: it waits for another bridge
  friend bool operator==(const BusClaim&, const BusClaim&) = default;
};

struct BridgeClaims {
  std::string bridge;
  std::string host;     // human-readable
  std::string process;  // see member_identity.hpp
  UtcTime since;        // when it joined the domain
  std::map<std::string, BusClaim> buses;
  std::string group{};  // its standby group; empty: none
  std::int32_t strength = 0;
  friend bool operator==(const BridgeClaims&, const BridgeClaims&) = default;
};

class BusClaims {
 public:
  // A bridge serves the bus after it has waited this long for bridges that also only wait.
  static constexpr Duration kMostUnserved = std::chrono::seconds{5};

  // `id`: identity of this bridge in DDS, unique in the domain; others have theirs.
  explicit BusClaims(std::string id = {}) : id_(std::move(id)) {}
  void set_id(std::string id) { id_ = std::move(id); }
  void set_group(std::string group) { group_ = std::move(group); }
  // While it stands by, another bridge of its group serves.
  void set_standing_by(bool standing_by) { standing_by_ = standing_by; }

  // ---- the others

  void receive(const std::string& id, BridgeClaims claims);  // replaces the previous claims
  // The lease of the bridge expired, or it is alive again. No effect before its announcement.
  void set_alive(const std::string& id, bool alive);
  void forget(const std::string& id);
  // Processes of other bridges on this machine, for set_alive().
  [[nodiscard]] std::map<std::string, std::string> processes() const;

  // Number of group members that are not in `bridges`.
  [[nodiscard]] std::size_t members_beside(const std::vector<std::string>& bridges) const;

  // Another member of the group with the name of this bridge; `own`: claims of this bridge. The one
  // that serves has priority, otherwise the one that joined earlier.
  struct Namesake {
    BridgeClaims claims;
    bool goes_first = false;
  };
  [[nodiscard]] std::optional<Namesake> namesake(const BridgeClaims& own) const;

  // ---- this bridge

  // Sets the wanted buses. New ones count from `now`; others are released.
  void want(const std::vector<std::string>& buses, UtcTime now);
  // The bridge that keeps this one from serving a bus; for a served bus: one that serves it as
  // well. `std::nullopt` if there is none. REQUIRES: the bus is wanted.
  [[nodiscard]] std::optional<BridgeClaims> rival(const std::string& bus) const;
  // Decides for each wanted bus whether this bridge serves it. Returns true if something changed:
  // the caller announces it. Call it repeatedly, because kMostUnserved depends on the time.
  bool decide(Instant now);
  [[nodiscard]] const std::map<std::string, BusClaim>& buses() const { return own_; }
  [[nodiscard]] bool serves(const std::string& bus) const;
  // Returns true if a live bridge, also of its group, wants a bus that this one wants.
  [[nodiscard]] bool are_wanted_elsewhere() const;
  // The buses that this bridge serves and a different bridge claims to serve as well.
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
